#pragma once

#include <span>
#include <vector>

namespace kolsky {

/// While a force is above a level, round its largest sample; places in samples, between them.
struct Stay {
  double begin = 0.0;
  double end = 0.0;
  bool over = false;              ///< it ends within the record
  double slopes[2] = {0.0, 0.0};  ///< at both ends, per sample, upwards into the stay
};

/// Zero of none.
[[nodiscard]] double mean_of(std::span<const double> values);
[[nodiscard]] std::size_t index_of_largest(std::span<const double> values);

/// @param peak  index of the sample that the stay is round
[[nodiscard]] Stay stay_above(std::span<const double> force, std::size_t peak, double level);

/// What a reduction says of a force, of one that was computed: the same low-pass, foot and
/// threshold.
struct ContactNumbers {
  std::vector<double>
      force_N;          ///< low-passed; sample n at n interval - foot, and as many as were given
  double foot_s = 0.0;  ///< where the reduction would put first touch
  double peak_force_N = 0.0;
  double contact_time_s = 0.0;
  double impulse_N_s = 0.0;
};

/// @param force_N    equally spaced from first touch on, back at zero at its end
/// @param threshold  share of the peak above which the contact lasts
[[nodiscard]] ContactNumbers contact_numbers(std::span<const double> force_N, double interval_s,
                                             double low_pass_Hz, double threshold);

}  // namespace kolsky
