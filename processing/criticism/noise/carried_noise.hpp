#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "processing/identification/noise_spectrum.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky {

/// The judged window within a record, in samples of one rate.
struct WindowInRecord {
  std::size_t judged = 0;  ///< samples of the window
  std::size_t before = 0;  ///< samples of the record before it, and after it
  std::size_t quiet = 0;   ///< at the record's start, whose mean is the baseline
  std::size_t decimation = 1;
  double filter_cycles = 0.5;  ///< per sample: where responses have ended
};

/// One bin's noise of several filters that share their input.
struct CarriedBin {
  Eigen::MatrixXcd power;  ///< filters x filters
  Eigen::VectorXcd ratio;  ///< what a wave of this frequency keeps, mean over the window
};

/// Noise of one gauge as a causal filter k carries it into a window, bin by bin: of
///     x(t) = sum_u k(t - u) n(u),    u within the record,
/// the mean square of X_k = sum_t x(t) exp(-i w_k t). What waves sent before the record began is
/// not in n, so x is not stationary however stationary n is: among bars that ring it grows echo by
/// echo. With A_k(u) = sum_t k(t - u) exp(-i w_k t), the partial sums of k's transform,
///     E X_k X_k^* = sum_uv A_k(u) C(u - v) A_k(v)^*,
/// C the noise's autocovariance: white at the bin's own power and parts of first-order
/// correlation, whose sums take one recursion each. The baseline, a mean over the quiet samples,
/// is noise of its own and taken off n before it is carried.
class CarriedNoise {
 public:
  /// Sums of the responses carried last. Most numbers of a fit move one gauge's response: the
  /// others' are not summed again. One thread at a time.
  class Memory;

  /// @param least_power  of white noise beside what the spectrum says (steps of a converter)
  CarriedNoise(const NoiseSpectrum& spectrum, double least_power, const WindowInRecord& window,
               std::size_t bins);
  ~CarriedNoise();
  CarriedNoise(const CarriedNoise&) = delete;
  CarriedNoise& operator=(const CarriedNoise&) = delete;

  /// @param responses  k by filter, from lag -before on, judged + 2 before samples
  /// @param memory     of this noise alone; changes how long it takes and no result
  /// @param bins       the result; its room serves again
  void through(std::span<const std::vector<double>> responses, Memory& memory,
               std::vector<CarriedBin>& bins) const;

 private:
  /// Noise that forgets slowly, over blocks of samples: covariance of two blocks' means.
  struct Part {
    double variance = 0.0;
    double within = 0.0;   ///< a block with itself
    double between = 0.0;  ///< with the next, over keep
    double keep = 0.0;     ///< from one block to the next
  };
  struct FourBins;
  struct Carried;
  struct PartialSums;
  struct Room;

  void put_turns();
  void put_at_strides(std::span<const std::vector<double>> responses, Carried& out) const;
  void carry(const PartialSums& sums, std::size_t four, const Carried* known, Carried& out) const;
  void put_noise_in(const Carried& carried, std::size_t four, Room& room) const;
  void add_slow_noise(std::size_t filters, Room& room) const;

  WindowInRecord window_;
  std::size_t stride_ = 1;  ///< the sums are formed at every so many samples
  std::size_t judged_ = 0;  ///< in strides, as the following
  std::size_t before_ = 0;
  std::size_t whole_ = 0;
  std::size_t block_ = 1;  ///< slow noise is looked at in blocks of so many
  std::size_t quiet_blocks_ = 1;
  std::vector<Part> slow_;
  std::size_t bins_ = 0;
  std::vector<FourBins> four_;
};

class CarriedNoise::Memory {
 public:
  Memory();
  ~Memory();
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

 private:
  friend class CarriedNoise;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kolsky
