#include "processing/criticism/records/lost_samples.hpp"

#include <algorithm>
#include <cmath>

#include "processing/reduction/code_steps.hpp"
#include "processing/reduction/pulse.hpp"

namespace kolsky {

namespace {

/// Samples to either side by which a jump is judged.
constexpr std::size_t kSide = 8;
constexpr double kOfNoise = 10.0;
/// Of the whole record's noise energy: what holds less changes nothing that is judged, whatever
/// made it.
constexpr double kOfNoiseEnergy = 0.1;
/// Of the largest step from sample to sample around: a front is one among others as steep.
constexpr double kOfSteps = 5.0;
/// How far from where it was it may come back, of the jump.
constexpr double kBack = 0.5;
/// No wave is so short; a longer jump from the baseline may be a pulse with steep edges.
constexpr std::size_t kNoPulse = 2;

double largest_step(std::span<const double> readings) {
  double largest = 0.0;
  for (std::size_t n = 1; n < readings.size(); ++n) {
    largest = std::max(largest, std::abs(readings[n] - readings[n - 1]));
  }
  return largest;
}

/// A run of one reading with kSide samples to either side of it.
/// @param quiet  of the record before its pulse
/// @param step   of its converter
bool jumps_and_is_back(std::span<const double> readings, const LostSamples& run, const Quiet& quiet,
                       double step) {
  const std::span<const double> before = readings.subspan(run.first - kSide, kSide);
  const std::span<const double> after = readings.subspan(run.first + run.count, kSide);
  const double there = readings[run.first] - before.back();
  const double back = after.front() - readings[run.first];
  const double jump = std::min(std::abs(there), std::abs(back));
  const bool from_pulse = std::abs(before.back() - quiet.baseline) > kBack * jump;
  const double noise_energy = std::pow(quiet.noise_rms, 2) * static_cast<double>(readings.size());
  return (run.count <= kNoPulse || from_pulse) && there * back < 0.0 &&
         jump > kOfNoise * quiet.noise_rms &&
         jump * jump * static_cast<double>(run.count) > kOfNoiseEnergy * noise_energy &&
         jump > kOfSteps * std::max({step, largest_step(before), largest_step(after)}) &&
         std::abs(after.front() - before.back()) < kBack * jump;
}

}  // namespace

std::optional<LostSamples> lost_samples(std::span<const double> readings, std::size_t quiet) {
  const Quiet before = quiet_before(readings, quiet);
  const double step = least_step(readings);
  LostSamples run{0, 1};
  for (std::size_t n = 1; n + kSide <= readings.size(); ++n) {
    if (readings[n] == readings[n - 1]) {
      ++run.count;
      continue;
    }
    if (run.first >= kSide && jumps_and_is_back(readings, run, before, step)) {
      return run;
    }
    run = {n, 1};
  }
  return std::nullopt;
}

}  // namespace kolsky
