#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/uncertainty/noise.hpp"

namespace kolsky {

/// What a converter's steps hide of a record, where its noise is too small to dither them: the
/// baseline is off by up to half a step, the same all along the record, and so is each stretch in
/// which the codes stand still.
///
/// The mean error of a quantiser under normal noise of deviation sigma falls as
/// exp(-2 pi^2 sigma^2 / step^2): what is drawn is uniform over a step times that. The noise is
/// taken from the quiet samples, less the step^2 / 12 that rounding itself adds to it.
class ConverterSteps {
 public:
  /// @param codes  the record; a table's may be a converter's many codes apart
  /// @param quiet  how many of them are before the pulse
  ConverterSteps(std::span<const std::int32_t> codes, std::size_t quiet);

  /// The smallest distance of two values in the record [codes]; 0 where it has one value.
  [[nodiscard]] double step() const { return step_; }
  /// Share of a step that is left of its error; next to nothing for noise of 0.6 of a step or more.
  [[nodiscard]] double undithered() const { return undithered_; }
  /// Whether there is anything to draw.
  [[nodiscard]] bool matters() const;

  /// Adds what the true readings may have been off by [codes].
  /// @param values  as many as the record's
  void add(RandomStream& random, std::vector<double>& values) const;

 private:
  /// Neighbouring samples of one code.
  struct Run {
    std::size_t begin = 0;
    std::size_t end = 0;
    bool passing = false;  ///< on the way from a code below to one above, or back
  };

  std::size_t quiet_ = 0;
  double step_ = 0.0;
  double undithered_ = 0.0;
  std::vector<Run> runs_;  ///< behind the quiet samples
};

}  // namespace kolsky
