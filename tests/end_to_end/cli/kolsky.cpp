#include "tests/end_to_end/cli/kolsky.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/end_to_end/process.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky::scene {

namespace {

#ifdef KOLSKY_SANITIZED
constexpr std::chrono::seconds kPatience{900};
constexpr bool kSlow = true;
#else
constexpr std::chrono::seconds kPatience{60};
constexpr bool kSlow = false;
#endif

std::string text_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::string bar_toml(const std::string& name, double length_m, const testing::ElasticShpb& model) {
  return fmt::format(
      "[bars.{}]\nlength_m = {}\ndiameter_m = {}\ndensity_kg_m3 = {}\npoisson_ratio = 0.3\n"
      "youngs_modulus_Pa = {}\n",
      name, length_m, model.diameter_m, model.density_kg_m3, model.youngs_modulus_Pa);
}

std::string gauge_toml(const std::string& name, const std::string& bar, double position_m) {
  return fmt::format(
      "[[gauges]]\nname = \"{}\"\nbar = \"{}\"\nposition_m = {}\nunit = \"strain\"\n", name, bar,
      position_m);
}

std::string bench_toml_of(const testing::ElasticShpb& model) {
  return fmt::format("kind = \"shpb\"\nsampling_frequency_Hz = {}\npositive = \"compression\"\n",
                     model.sampling_frequency_Hz) +
         bar_toml("input", model.length_in_m, model) +
         bar_toml("output", model.length_out_m, model) +
         gauge_toml("g1", "input", model.length_in_m - model.gauge_to_A_m) +
         gauge_toml("g2", "output", model.gauge_to_B_m) +
         (model.second_to_A_m ? gauge_toml("g3", "input", model.length_in_m - *model.second_to_A_m)
                              : std::string()) +
         fmt::format("[specimen]\nlength_m = {}\ndiameter_m = {}\n", model.specimen_length_m,
                     model.specimen_diameter_m);
}

std::string table_of(const testing::ElasticShpb& model, const testing::ElasticShpb::Records& shot) {
  std::string text = shot.second_strain.empty() ? "time_s,g1,g2\n" : "time_s,g1,g2,g3\n";
  for (std::size_t i = 0; i < shot.input_strain.size(); ++i) {
    text +=
        fmt::format("{:.9e},{:.9e},{:.9e}", static_cast<double>(i) / model.sampling_frequency_Hz,
                    shot.input_strain[i], shot.output_strain[i]);
    text += shot.second_strain.empty() ? "\n" : fmt::format(",{:.9e}\n", shot.second_strain[i]);
  }
  return text;
}

}  // namespace

Answer kolsky(const std::vector<std::string>& words, const std::vector<std::string>& environment) {
  const testing::ScratchFolder folder;
  // The shell parts the error stream from the other.
  std::vector<std::string> command{"/bin/sh", "-c", "exec \"$@\" 2>\"$0\"", folder / "err", KOLSKY};
  command.insert(command.end(), words.begin(), words.end());
  Process process(command, folder / "out", environment);
  const std::optional<int> code = process.wait(kPatience);
  return {code.value_or(-1), process.output(), text_of(folder / "err")};
}

nlohmann::json json_of(const Answer& answer) {
  EXPECT_EQ(answer.code, 0) << answer.err;
  // What takes long tells how far it is.
  EXPECT_TRUE(kSlow || answer.err.empty()) << answer.err;
  nlohmann::json parsed = nlohmann::json::parse(answer.out, nullptr, false);
  EXPECT_TRUE(parsed.is_object()) << answer.out.substr(0, 200);
  return parsed;
}

::testing::AssertionResult refused(const Answer& answer, const std::vector<std::string>& named) {
  if (answer.code != 2 || !answer.out.empty()) {
    return ::testing::AssertionFailure()
           << "exit code " << answer.code << ", stdout: " << answer.out
           << ", stderr: " << answer.err;
  }
  if (std::count(answer.err.begin(), answer.err.end(), '\n') != 1 || !answer.err.ends_with("\n")) {
    return ::testing::AssertionFailure() << "not one line: " << answer.err;
  }
  for (const std::string& part : named) {
    if (answer.err.find(part) == std::string::npos) {
      return ::testing::AssertionFailure() << "no '" << part << "' in: " << answer.err;
    }
  }
  return ::testing::AssertionSuccess();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

Bench::Bench(const testing::ElasticShpb& model) : model_(model), records_(model_.solve()) {
  write("bench.toml", bench_toml_of(model_));
  write("shot.csv", table_of(model_, records_));
}

std::string Bench::table(double share, double noise_strain, unsigned seed) const {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, noise_strain);
  testing::ElasticShpb::Records scaled = records_;
  for (std::vector<double>* strain :
       {&scaled.input_strain, &scaled.output_strain, &scaled.second_strain}) {
    for (double& value : *strain) {
      value = share * value + noise(random);
    }
  }
  return table_of(model_, scaled);
}

std::string Bench::capture(const std::string& name) const {
  const Answer answer =
      kolsky({"import", "csv", file("shot.csv"), "--bench", file("bench.toml"), "-o", file(name)});
  EXPECT_EQ(answer.code, 0) << answer.err;
  return file(name);
}

}  // namespace kolsky::scene
