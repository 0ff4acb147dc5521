// Runs benchmarks as benchmark_main does. With --hold RATIO the command fails where a bound (see
// hold_to) over the time that was measured, the best of its repetitions, is less than that: 1 for
// the bound itself, less for a machine that is slower or busy with other work.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>

#include "drivers/memory/kept_memory.hpp"

namespace {

class HoldingReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      const auto bound = run.counters.find("bound_over_time");
      if (run.run_type == Run::RT_Iteration && bound != run.counters.end()) {
        double& best = best_[run.benchmark_name()];
        best = std::max(best, bound->second.value);
      }
    }
  }

  /// How many bounds are missed; says which.
  [[nodiscard]] int missed(double ratio) const {
    int count = 0;
    for (const auto& [name, best] : best_) {
      if (best < ratio) {
        std::fprintf(stderr, "%s: bound over time is %.3g, less than %g\n", name.c_str(), best,
                     ratio);
        ++count;
      }
    }
    return count;
  }

  [[nodiscard]] bool has_none() const { return best_.empty(); }

 private:
  std::map<std::string, double> best_;
};

/// Takes --hold RATIO out of the arguments. @return whether it can be read; 0 where it is not given
bool take_hold(int& argc, char** argv, double& ratio) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--hold") != 0) {
      continue;
    }
    if (i + 1 == argc) {
      return false;
    }
    const char* const end = argv[i + 1] + std::strlen(argv[i + 1]);
    if (std::from_chars(argv[i + 1], end, ratio).ptr != end || !(ratio > 0.0)) {
      return false;
    }
    std::move(argv + i + 2, argv + argc + 1, argv + i);
    argc -= 2;
    return true;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  kolsky::keep_freed_memory();  // as the programs do
  double ratio = 0.0;
  if (!take_hold(argc, argv, ratio)) {
    std::fprintf(stderr,
                 "--hold needs a positive number: the least bound over time, 1 as a rule\n");
    return 2;
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return 2;
  }
  HoldingReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  if (ratio > 0.0 && reporter.has_none()) {
    std::fprintf(stderr, "--hold: no benchmark that was run has a bound\n");
    return 2;
  }
  return ratio > 0.0 && reporter.missed(ratio) > 0 ? 1 : 0;
}
