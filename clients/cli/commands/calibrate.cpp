#include <memory>
#include <ostream>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/captures.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/judged_records.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/calibration_report.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/cli/slow_work.hpp"
#include "clients/cli/threads.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

constexpr mode_t kReadableByAll = 0644;

struct Settings {
  std::vector<std::string> captures;
  std::optional<std::string> bench;
  std::optional<std::string> bench_out;
  std::optional<std::string> bar_model;
  std::optional<double> band_limit_Hz;
  std::vector<std::string> trusted;
};

CalibrationOptions options_from(const Settings& settings, const std::vector<Shot>& shots) {
  CalibrationOptions options;
  options.band_limit_Hz = band_limit_of(settings.band_limit_Hz);
  options.trusted = settings.trusted;
  options.workers = all_cores();
  if (settings.bar_model) {
    const BarModelFile model = read_bar_model(*settings.bar_model);
    for (const Shot& shot : shots) {
      require_holds(model, shot);
    }
    options.bars = model.prior;
  } else if (!shots.empty() && shots.front().bar_model) {
    options.bars = BarPrior(*shots.front().bar_model);
  }
  return options;
}

int run(const Settings& settings, Context& context) {
  require_new_output(settings.bench_out);
  std::vector<Shot> shots = read_shots(settings.captures);
  if (settings.bench) {
    for (Shot& shot : shots) {
      rebench(shot, *settings.bench);
    }
  }
  CalibrationOptions options = options_from(settings, shots);
  SlowWork progress("kolsky calibrate");
  options.progress = [&progress](const std::string& step) { progress.at(step); };
  const Calibration calibration = [&] {
    try {
      return calibrate(shots, options);
    } catch (const InputError& error) {
      throw in_captures(error, settings.captures);
    }
  }();
  const Shot& first = shots.front();
  // First what was found: a file that cannot be made takes none of it away.
  context.out << (context.json ? to_text(describe(calibration, first.bench)) + "\n"
                               : report(calibration, first.bench));
  if (settings.bench_out) {
    NewFile file(*settings.bench_out);
    const std::string text = edit_bench(first.bench_toml, corrections(calibration, first.bench));
    (void)parse_bench(text, *settings.bench_out);
    file.write(text);
    file.publish(kReadableByAll);
  }
  return kDone;
}

}  // namespace

Command calibrate_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "calibrate";
  command.purpose =
      "holds a bench file against shots fired to check it: gains, places, delays, wave speed\n"
      "Bars together without a specimen, one bar by itself, or a bar to be characterised; what\n"
      "differs from the file by more than three deviations is named, with the number to put there.";
  command.examples =
      "  kolsky calibrate together1.h5 together2.h5 --bench-out bench2.toml\n"
      "  kolsky calibrate shots/ --bench corrected.toml --json > certificate.json\n"
      "  kolsky calibrate shots/ --trust g1 --bar-model pmma.toml\n";
  command.arguments = {
      needed("CAPTURE", "", "captures of the shots, or folders of them", &s.captures),
      option("--bench", "B.toml", "the bench file to check; else the captures' own", &s.bench),
      option("--bench-out", "B2.toml",
             "corrected bench file to write, with deviations; never in the place of another",
             &s.bench_out),
      option("--bar-model", "M.toml", "what viscoelastic bars are filed to be; else found",
             &s.bar_model),
      option("--trust", "GAUGE", "a gauge whose numbers count as right, where shots cannot tell",
             &s.trusted),
      option("--band-limit", "HZ", "upper end of the frequencies used; else what the noise allows",
             &s.band_limit_Hz)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli
