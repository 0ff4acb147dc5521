#include "processing/criticism/noise/response_end.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

void end_where_unresolved(std::vector<double>& response, double growth, std::size_t first) {
  constexpr double kUnresolved = 3e-10;
  double peak = 0.0;
  for (const double value : response) {
    peak = std::max(peak, std::abs(value));
  }
  for (std::size_t n = response.size(); n > 0; --n) {
    const double ripple =
        kUnresolved * peak * std::exp(growth * static_cast<double>(first + n - 1));
    if (std::abs(response[n - 1]) > ripple) {
      return;
    }
    response[n - 1] = 0.0;
  }
}

}  // namespace kolsky
