#include "tests/hidden_effects/analyser.hpp"

#include <fmt/format.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace kolsky::scoring {

namespace {

std::string quoted(const std::string& word) {
  return "'" + word + "'";
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

// One command; its outputs stay beside the case.
Answer run(const Analyser& analyser, const CaseFiles& files, const std::string& name,
           const std::string& arguments) {
  const std::filesystem::path out = files.folder / (name + ".json");
  const std::filesystem::path error = files.folder / (name + ".err");
  const std::string command =
      fmt::format("timeout -k 5 {:.0f} {} {} > {} 2> {}", analyser.timeout_s,
                  quoted(analyser.program), arguments, quoted(out), quoted(error));
  const auto begin = std::chrono::steady_clock::now();
  const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe)
  Answer answer;
  answer.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  answer.code = WIFEXITED(status) ? WEXITSTATUS(status) : 255;
  answer.error = text_of(error);
  answer.json = nlohmann::json::parse(text_of(out), nullptr, false);
  if (answer.json.is_discarded()) {
    answer.json = nullptr;
  }
  return answer;
}

std::string captures_of(const CaseFiles& files) {
  std::string words;
  for (const auto& capture : files.captures) {
    words += " " + quoted(capture);
  }
  return words;
}

}  // namespace

Answer diagnose(const Analyser& analyser, const CaseFiles& files) {
  const std::filesystem::path model = files.folder / "model.toml";
  std::string materials;
  for (const auto& [option, file] : {std::pair{" --bar-model ", files.bars},
                                     {" --core ", files.core},
                                     {" --cover ", files.cover}}) {
    materials += file.empty() ? "" : option + quoted(file);
  }
  Answer made = run(analyser, files, "model-new",
                    fmt::format("model new --kind {} --bench {}{} -o {} --json", files.kind,
                                quoted(files.bench), materials, quoted(model)));
  if (made.code != 0) {
    return made;
  }
  return run(analyser, files, "diagnose",
             fmt::format("diagnose{} --model {} -o {} --json {}", captures_of(files), quoted(model),
                         quoted(files.folder / "found.toml"), analyser.more));
}

Answer compare_base(const Analyser& analyser, const CaseFiles& files) {
  const std::filesystem::path fitted = files.folder / "base.toml";
  Answer fit = run(analyser, files, "fit-base",
                   fmt::format("fit{} --model {} -o {} --json", captures_of(files),
                               quoted(files.folder / "model.toml"), quoted(fitted)));
  if (fit.code != 0) {
    return fit;
  }
  return run(analyser, files, "compare",
             fmt::format("compare{} --model {} --json", captures_of(files), quoted(fitted)));
}

Answer compare_found(const Analyser& analyser, const CaseFiles& files) {
  return run(analyser, files, "compare-found",
             fmt::format("compare{} --model {} --json", captures_of(files),
                         quoted(files.folder / "found.toml")));
}

Answer waterfall(const Analyser& analyser, const CaseFiles& files) {
  return run(analyser, files, "waterfall",
             fmt::format("model waterfall {}{} --json", quoted(files.folder / "found.toml"),
                         captures_of(files)));
}

Answer refit(const Analyser& analyser, const CaseFiles& files) {
  return run(
      analyser, files, "fit",
      fmt::format("fit{} --model {} -o {} --json", captures_of(files),
                  quoted(files.folder / "found.toml"), quoted(files.folder / "fitted.toml")));
}

}  // namespace kolsky::scoring
