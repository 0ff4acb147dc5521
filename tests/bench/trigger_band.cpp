// Prints how often the incident trigger misses a pulse and how often it fires without one, against
// the ratio of the pulse's peak to the rms of the random noise. 1 MHz, the settings of
// TriggerOptions::for_rate.
//   trigger_band [minutes of baseline per row, 10] [pulses per cell, 1000]

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <vector>

#include "processing/trigger/incident_trigger.hpp"
#include "tests/unit/trigger/signals.hpp"

namespace {

using namespace kolsky;

constexpr double kRate_Hz = 1e6;
constexpr double kNoise_codes = 20.0;
constexpr std::size_t kBlock = 4096;

struct Row {
  const char* name;
  signals::Background background;
};

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows = {
      {"white noise", {.noise_codes = kNoise_codes}},
      {"coloured noise, 100 kHz", {.noise_codes = kNoise_codes, .memory = 0.53}},
      {"coloured noise, 10 kHz", {.noise_codes = kNoise_codes, .memory = 0.94}},
      {"white, 50 Hz hum of 20 sigma",
       {.noise_codes = kNoise_codes, .hum_codes = 20 * kNoise_codes}},
      {"white, 50 Hz hum of 100 sigma and 250 Hz of 10",
       {.noise_codes = kNoise_codes,
        .hum_codes = 100 * kNoise_codes,
        .harmonic_codes = 10 * kNoise_codes}},
      {"white, drift to and fro, 2000 sigma per s",
       {.noise_codes = kNoise_codes, .hum_codes = 1000 * kNoise_codes, .hum_period = 3.14e6}},
      {"white, 100 spikes per s to 500 sigma, to 4 us",
       {.noise_codes = kNoise_codes,
        .spikes = 1e-4,
        .spike_codes = 500 * kNoise_codes,
        .spike_samples = 4}},
      {"white, 0.3 codes rms", {.noise_codes = 0.3, .offset_codes = 0.4}},
  };
  return kRows;
}

std::optional<TriggerEvent> feed(IncidentTrigger& trigger, Tick first,
                                 const std::vector<std::int16_t>& codes) {
  return trigger.feed(first, codes, run_statistics(codes));
}

struct Score {
  int fired = 0;
  int missed = 0;
  double error = 0.0;
  double error_square = 0.0;
  double stated_square = 0.0;
};

// One pulse per 5 ms at a random phase of everything.
Score pulses(const signals::Background& background, double peak_sigma, int count) {
  TriggerOptions options = TriggerOptions::for_rate(kRate_Hz);
  options.hold_off_samples = 1000;
  IncidentTrigger trigger(options);
  signals::Source source(background, 1);
  // Below a code the floor of the noise, half a code, is what counts.
  const double unit = std::max(background.noise_codes, options.minimum_noise_codes);
  signals::Pulse pulse;
  pulse.peak_codes = peak_sigma * unit;
  const double crossing = peak_sigma > 8.0 ? pulse.reaches(8.0 * unit) : pulse.rise;
  std::vector<std::int16_t> codes(5000);
  Score score;
  Tick first = 0;
  for (int shot = -20; shot < count; ++shot) {
    const double foot = 3000.0 + source.uniform();
    for (std::size_t i = 0; i < codes.size(); ++i) {
      double value = source.next();
      if (shot >= 0) value += pulse.at(static_cast<double>(i) - foot);
      codes[i] = signals::quantised(value);
    }
    const auto event = feed(trigger, first, codes);
    const double error =
        event ? static_cast<double>(event->tick - first) + event->fraction - foot - crossing : 1e9;
    if (shot >= 0 && std::abs(error) < 60.0) {
      ++score.fired;
      score.error += error;
      score.error_square += error * error;
      score.stated_square += event->sigma_samples * event->sigma_samples;
    } else if (shot >= 0) {
      ++score.missed;
    }
    first += static_cast<Tick>(codes.size());
  }
  return score;
}

int false_triggers(const signals::Background& background, double level_sigma, double minutes) {
  TriggerOptions options = TriggerOptions::for_rate(kRate_Hz);
  options.hold_off_samples = 1000;
  options.level_sigma = level_sigma;
  IncidentTrigger trigger(options);
  signals::Source source(background, 2);
  std::vector<std::int16_t> codes(kBlock);
  int fired = 0;
  const auto samples = static_cast<Tick>(minutes * 60.0 * kRate_Hz);
  for (Tick first = 0; first < samples; first += static_cast<Tick>(kBlock)) {
    for (std::int16_t& code : codes) code = signals::quantised(source.next());
    fired += feed(trigger, first, codes) ? 1 : 0;
  }
  return fired;
}

void print_missed(int count) {
  const double peaks[] = {6, 7, 8, 8.5, 9, 10, 12, 15, 20, 40};
  std::printf("Missed pulses in %% of %d (170 us long, 30 us rise), by peak over rms noise\n\n|",
              count);
  for (const double peak : peaks) std::printf(" | %g", peak);
  std::printf(" |\n|---|");
  for ([[maybe_unused]] const double peak : peaks) std::printf("---|");
  std::printf("\n");
  for (const Row& row : rows()) {
    std::printf("| %s", row.name);
    for (const double peak : peaks) {
      const Score score = pulses(row.background, peak, count);
      std::printf(" | %.1f", 100.0 * score.missed / count);
    }
    std::printf(" |\n");
  }
}

void print_times(int count) {
  const double peaks[] = {10, 12, 15, 20, 40, 100, 300};
  std::printf(
      "\nTime of the crossing in us, by peak over rms noise: mean after the true crossing of 8 "
      "sigma, "
      "scatter / stated sigma\n\n|");
  for (const double peak : peaks) std::printf(" | %g", peak);
  std::printf(" |\n|---|");
  for ([[maybe_unused]] const double peak : peaks) std::printf("---|");
  std::printf("\n");
  for (const Row& row : rows()) {
    std::printf("| %s", row.name);
    for (const double peak : peaks) {
      const Score score = pulses(row.background, peak, count);
      const double n = std::max(1, score.fired);
      const double bias = score.error / n;
      std::printf(" | %+.2f, %.2f / %.2f", bias,
                  std::sqrt(std::max(0.0, score.error_square / n - bias * bias)),
                  std::sqrt(score.stated_square / n));
    }
    std::printf(" |\n");
  }
}

void print_false(double minutes) {
  const double levels[] = {3, 4, 5, 6, 8};
  std::printf(
      "\nFalse triggers per hour of baseline, by level in sigma; counted over %g minutes at 8, %g "
      "below\n\n|",
      minutes, minutes / 10.0);
  for (const double level : levels) std::printf(" | %g", level);
  std::printf(" |\n|---|---|---|---|---|---|\n");
  for (const Row& row : rows()) {
    std::printf("| %s", row.name);
    for (const double level : levels) {
      const double counted = level < 8.0 ? minutes / 10.0 : minutes;
      std::printf(" | %.0f", false_triggers(row.background, level, counted) * 60.0 / counted);
      std::fflush(stdout);
    }
    std::printf(" |\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double minutes = argc > 1 ? std::atof(argv[1]) : 10.0;
  const int count = argc > 2 ? std::atoi(argv[2]) : 1000;
  print_missed(count);
  print_times(count);
  print_false(minutes);
}
