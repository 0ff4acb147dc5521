#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace kolsky {

/// The quiet part of a record ends this long before the pulse's foot.
inline constexpr double kFootClearance_s = 10e-6;

/// What a record is before its pulse.
struct Quiet {
  double baseline = 0.0;
  double noise_rms = 0.0;
  std::size_t samples = 0;  ///< how many it was taken from
};

/// Mean and standard deviation of the samples before `end`.
[[nodiscard]] Quiet quiet_before(std::span<const double> record, std::size_t end);

/// Where the first pulse of a record rises through half of its peak.
struct Rise {
  std::size_t index = 0;  ///< last sample below half of the peak
  double sense = 1.0;     ///< sign of the pulse
};

/// Finds the first pulse: the first run of at least `width` samples that stays above both six times
/// the noise of the record's beginning and a share of the record's largest excursion, followed to
/// half of the largest excursion within `reach` samples. The beginning is 32 samples or a hundredth
/// of the record; where nothing stands out of that, 16 or 8, and the pulse comes after them.
/// @param reach  how far the pulse's own peak can be
/// @param least_share  of the largest excursion
/// @return nothing where no such run exists
[[nodiscard]] std::optional<Rise> find_first_pulse(std::span<const double> record,
                                                   std::size_t width, std::size_t reach,
                                                   double least_share = 0.1);

/// The pulse whose foot is given by hand, followed to half of its largest excursion within `reach`
/// samples.
/// @param foot  in samples
/// @throws InputError "arrival_s" where the foot is off the record, or what rises within reach of
/// it
///   is less than a fifth of the record's largest excursion
[[nodiscard]] Rise rise_after_foot(std::span<const double> record, double foot, std::size_t reach,
                                   double rate_Hz);

/// The foot of a pulse, in samples from the start of the record.
struct Foot {
  double index = 0.0;
  double sigma = 0.0;  ///< one standard deviation: of the noise and of the rise's shape
};

/// The foot from the times at which the rise passes 10, 20 and 40 % of the peak: a rise like
/// a (t - t0)^p passes them at distances from t0 in the ratio 2^(1/p), whatever a and p are. p is
/// held between 1 (a ramp) and 3. Of another shape it is off, by about twice of what 5, 10 and 20 %
/// find elsewhere, which its deviation holds.
/// @param record  less its baseline, positive in the pulse's sense
/// @param half    last sample below half of the peak, as `find_first_pulse` gives
[[nodiscard]] Foot foot_of(std::span<const double> record, std::size_t half, double peak,
                           double noise_rms);

}  // namespace kolsky
