#pragma once

#include <complex>
#include <functional>
#include <vector>

namespace kolsky::testing {

/// A history as the sum of its Fourier lines: f(t) = 1/T sum F(w) e^{iwt}, with f dead before T
/// ends. The transform is damped (w - i a) so that slow tails cannot wrap round.
[[nodiscard]] std::vector<double> from_spectrum(
    const std::function<std::complex<double>(std::complex<double>)>& spectrum_at_iw,
    double period_s, double highest_Hz, double step_s, std::size_t samples);

/// Spectrum of the unit source of that knot, at s = iw + damping.
[[nodiscard]] std::complex<double> unit_source_spectrum(std::complex<double> s, double knot_s);

}  // namespace kolsky::testing
