#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

namespace kolsky {

/// What a share of intervals that hold the truth is held to: from the least to the most, and so
/// much beside as chance does to the share of so many repeats (two of a binomial's deviations).
class HeldCoverage {
 public:
  /// @param hold  takes what `--hold 94,96` gives
  static void add_option(CLI::App& app, std::vector<double>& hold) {
    app.add_option("--hold", hold,
                   "least and most percent inside, as 94,96: fails where a share is outside by "
                   "more\nthan two deviations of that many repeats")
        ->delimiter(',')
        ->expected(2);
  }

  /// @param least_and_most_percent  empty: nothing is held
  HeldCoverage(std::vector<double> least_and_most_percent, double repeats)
      : held_(std::move(least_and_most_percent)),
        allowance_percent_(100.0 * 2.0 * std::sqrt(0.95 * 0.05 / repeats)) {}

  /// Says what is held.
  void state() const {
    if (!held_.empty()) {
      std::printf("held to %g to %g %% inside, and %.2f %% beside, which chance does\n", held_[0],
                  held_[1], allowance_percent_);
    }
  }

  /// " outside" where a share is; it then counts as missed.
  const char* judge(double inside_percent) {
    if (held_.empty() || (inside_percent >= held_[0] - allowance_percent_ &&
                          inside_percent <= held_[1] + allowance_percent_)) {
      return "";
    }
    ++missed_;
    return "  outside what is held";
  }

  [[nodiscard]] int missed() const { return missed_; }

 private:
  std::vector<double> held_;
  double allowance_percent_;
  int missed_ = 0;
};

}  // namespace kolsky
