#pragma once

#include "processing/base/bench.hpp"

namespace kolsky::accuracy {

/// A step that passes a gauge and comes back from an end, turned round: what its area under that
/// gauge is off by when it is summed from samples, rms over where the samples fall. By Poisson's
/// sum that is the step's spectrum at the sampling rate (exact waves; twice and more of the rate
/// left out).
/// @param to_end_m  from the gauge
/// @param rise_s  of the step, a raised cosine; 0 for none
[[nodiscard]] double area_by_sampling(const Bar& bar, double modulus_Pa, double to_end_m,
                                      double period_s, double rise_s);

}  // namespace kolsky::accuracy
