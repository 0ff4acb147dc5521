#pragma once

#include <span>

namespace kolsky {

/// Takes out the delay by which a channel records late: afterwards record(t) is what it was at
/// t + delay. Whole samples move as they are; a fraction of one is interpolated by a windowed sinc
/// of 32 samples, exact to 1e-4 up to 0.42 of the sampling rate. What was never recorded, beyond
/// either end, is taken to be as the last sample there.
void take_out_delay(double delay_s, double sample_rate_Hz, std::span<double> record);

}  // namespace kolsky
