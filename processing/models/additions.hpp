#pragma once

#include <vector>

namespace kolsky {

/// addition(t) += of(t) at each time; an empty addition starts as zeros.
template <typename Function>
void add_to(std::vector<double>& addition, const std::vector<double>& time_s, Function of) {
  addition.resize(time_s.size(), 0.0);
  for (std::size_t n = 0; n < time_s.size(); ++n) {
    addition[n] += of(time_s[n]);
  }
}

}  // namespace kolsky
