#include "processing/uncertainty/monte_carlo.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "processing/reduction/loop_summary.hpp"
#include "processing/uncertainty/noisy_shot.hpp"
#include "processing/uncertainty/scatter.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kChunk = 64;          // draws by one worker, however many there are
constexpr std::size_t kNoiseOnlyShare = 5;  // one draw in so many more, for the budget
constexpr std::size_t kHistories = 5;

using Histories = std::array<std::vector<double>, kHistories>;

struct FigureKind {
  const char* name;
  double LoopSummary::*member;
  bool is_extreme = false;  ///< of noisy samples: noise only adds to it
};
constexpr std::array kFigures{
    FigureKind{"peak_stress_Pa", &LoopSummary::peak_stress_Pa, true},
    FigureKind{"strain_at_peak", &LoopSummary::strain_at_peak},
    FigureKind{"peak_strain", &LoopSummary::peak_strain},
    FigureKind{"mean_strain_rate_per_s", &LoopSummary::mean_strain_rate_per_s}};

using Figures = std::array<double, kFigures.size()>;

Figures figures_of(const LoopSummary& summary) {
  Figures figures{};
  for (std::size_t i = 0; i < kFigures.size(); ++i) {
    figures[i] = summary.*kFigures[i].member;
  }
  return figures;
}

std::array<const std::vector<double>*, kHistories> histories_of(const Reduction& r) {
  return {&r.stress_Pa, &r.strain, &r.strain_rate_per_s, &r.force_front_N, &r.force_back_N};
}

/// What came of one draw, on the times of the shot's own reduction.
struct Draw {
  bool good = false;
  Figures figures{};
  Histories histories;
};

/// Linear between the draw's own times: its t = 0 is its own arrival.
std::vector<double> at_times(const std::vector<double>& times, const Reduction& draw,
                             const std::vector<double>& history) {
  const double start = draw.time_s.front();
  const double step = draw.time_s[1] - draw.time_s[0];
  const auto last = static_cast<double>(history.size() - 1);
  std::vector<double> values(times.size());
  for (std::size_t n = 0; n < times.size(); ++n) {
    const double index = std::clamp((times[n] - start) / step, 0.0, last);
    const auto i = std::min(static_cast<std::size_t>(index), history.size() - 2);
    const double share = index - static_cast<double>(i);
    values[n] = history[i] * (1.0 - share) + history[i + 1] * share;
  }
  return values;
}

/// The band, the histories' length and how waves are separated are the shot's.
ReductionOptions held(ReductionOptions options, const Reduction& nominal) {
  options.band_limit_Hz = nominal.band_limit_Hz;
  options.duration_s = nominal.time_s.back();
  options.separation = nominal.separation;
  return options;
}

/// Where the band would end if the noise alone ended it.
double widest_band_Hz(const Shot& shot, ReductionOptions options, const Reduction& nominal) {
  options = held(std::move(options), nominal);
  options.band_limit_Hz.reset();
  options.most_band_Hz = shot.rate.Hz() / 2.0;
  return Reducer(std::move(options)).reduce(shot).band_limit_Hz;
}

/// Reduces moved copies of a shot; one per thread.
class Worker {
 public:
  Worker(const Shot& shot, const ReductionOptions& options, const Reduction& nominal,
         const std::vector<UncertaintySource>& sources)
      : shot_(shot),
        moved_(shot, nominal.quiet_samples),
        options_(held(options, nominal)),
        nominal_(nominal),
        has_loading_(summarise(nominal).no_loading.empty()),
        sources_(sources) {}

  /// @param moves  one per source
  /// @param noise  draws it; none: the samples as they are
  /// @param steps  likewise what the converters' steps hide
  Draw draw(const std::vector<double>& moves, RandomStream* noise, RandomStream* steps) {
    ShotNumbers numbers{shot_.bench, *options_.bar_model, 0.0, nominal_.band_limit_Hz};
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      sources_[i].move(numbers, moves[i]);
    }
    moved_.set_bench(std::move(numbers.bench));
    moved_.record(noise, steps);
    reducer_.set_bar_model(numbers.bars);
    reducer_.set_push_goes_on(numbers.push_goes_on);
    reducer_.set_band_limit_Hz(numbers.band_limit_Hz);
    const Reduction reduction = reducer_.reduce(moved_.shot());
    Draw result;
    const LoopSummary summary = summarise(reduction);
    result.good = reduction.quality.reducible && reduction.time_s.size() > 1 &&
                  (summary.no_loading.empty() || !has_loading_);
    if (result.good) {
      result.figures = figures_of(summary);
      const auto histories = histories_of(reduction);
      for (std::size_t h = 0; h < kHistories; ++h) {
        result.histories[h] = at_times(nominal_.time_s, reduction, *histories[h]);
      }
    }
    return result;
  }

 private:
  const Shot& shot_;
  NoisyShot moved_;
  ReductionOptions options_;
  const Reduction& nominal_;
  const bool has_loading_;
  const std::vector<UncertaintySource>& sources_;
  Reducer reducer_{options_};
};

Band band_of(const std::vector<Draw>& draws, std::size_t history, std::size_t samples) {
  Band band;
  std::vector<double> values;
  for (std::size_t n = 0; n < samples; ++n) {
    values.clear();
    for (const Draw& draw : draws) {
      if (draw.good) {
        values.push_back(draw.histories[history][n]);
      }
    }
    band.sd.push_back(sd_of(values));
    band.low.push_back(quantile(values, kLow));
    band.high.push_back(quantile(values, kHigh));
  }
  return band;
}

std::vector<double> figure_values(std::span<const Draw> draws, std::size_t figure) {
  std::vector<double> values;
  for (const Draw& draw : draws) {
    if (draw.good) {
      values.push_back(draw.figures[figure]);
    }
  }
  return values;
}

/// All work as numbered draws: the joint ones, those with noise alone, those with the converters'
/// steps alone where these matter, and two per source.
class Campaign {
 public:
  Campaign(std::size_t joint, std::size_t sources, bool steps)
      : joint_(joint),
        noise_only_(std::max<std::size_t>(2, joint / kNoiseOnlyShare)),
        steps_only_(steps ? noise_only_ : 0),
        sources_(sources) {}

  [[nodiscard]] std::size_t count() const { return first_of_sources() + 2 * sources_; }

  void run(std::size_t number, std::uint64_t seed, Worker& worker, Draw& draw) const {
    RandomStream random(seed, number);
    std::vector<double> moves(sources_, 0.0);
    if (number < joint_) {
      std::generate(moves.begin(), moves.end(), [&] { return random.normal(); });
      draw = worker.draw(moves, &random, steps_only_ > 0 ? &random : nullptr);
    } else if (number < joint_ + noise_only_) {
      draw = worker.draw(moves, &random, nullptr);
    } else if (number < first_of_sources()) {
      draw = worker.draw(moves, nullptr, &random);
    } else {
      const std::size_t of_source = number - first_of_sources();
      moves[of_source / 2] = of_source % 2 == 0 ? 1.0 : -1.0;
      draw = worker.draw(moves, nullptr, nullptr);
    }
  }

  [[nodiscard]] std::span<const Draw> noise_only(const std::vector<Draw>& draws) const {
    return std::span(draws).subspan(joint_, noise_only_);
  }
  /// Empty where no converter's steps matter.
  [[nodiscard]] std::span<const Draw> steps_only(const std::vector<Draw>& draws) const {
    return std::span(draws).subspan(joint_ + noise_only_, steps_only_);
  }
  [[nodiscard]] const Draw& moved(const std::vector<Draw>& draws, std::size_t source,
                                  bool up) const {
    return draws[first_of_sources() + 2 * source + (up ? 0 : 1)];
  }

 private:
  [[nodiscard]] std::size_t first_of_sources() const { return joint_ + noise_only_ + steps_only_; }

  std::size_t joint_;
  std::size_t noise_only_;
  std::size_t steps_only_;
  std::size_t sources_;
};

std::vector<BudgetLine> budget_of(const Campaign& campaign, const std::vector<Draw>& draws,
                                  const std::vector<UncertaintySource>& sources) {
  std::map<std::string, Figures> variances;
  for (std::size_t f = 0; f < kFigures.size(); ++f) {
    variances["noise"][f] = std::pow(sd_of(figure_values(campaign.noise_only(draws), f)), 2);
    if (const auto steps = campaign.steps_only(draws); !steps.empty()) {
      variances["converter"][f] = std::pow(sd_of(figure_values(steps, f)), 2);
    }
  }
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Draw& up = campaign.moved(draws, i, true);
    const Draw& down = campaign.moved(draws, i, false);
    if (!up.good || !down.good) {
      continue;
    }
    Figures& line = variances[sources[i].group];
    for (std::size_t f = 0; f < kFigures.size(); ++f) {
      line[f] += std::pow((up.figures[f] - down.figures[f]) / 2.0, 2);
    }
  }
  Figures sums{};
  for (const auto& [group, line] : variances) {
    for (std::size_t f = 0; f < kFigures.size(); ++f) {
      sums[f] += line[f];
    }
  }
  std::vector<BudgetLine> budget;
  for (const auto& [group, line] : variances) {
    BudgetLine entry{group, {}, {}};
    for (std::size_t f = 0; f < kFigures.size(); ++f) {
      entry.sd.push_back(std::sqrt(line[f]));
      entry.share.push_back(sums[f] > 0.0 ? line[f] / sums[f] : 0.0);
    }
    budget.push_back(std::move(entry));
  }
  std::stable_sort(budget.begin(), budget.end(), [](const BudgetLine& a, const BudgetLine& b) {
    return a.sd.front() > b.sd.front();
  });
  return budget;
}

/// Those that cannot be moved by a deviation to both sides without a draw that cannot be reduced.
std::vector<std::string> uncounted(const Campaign& campaign, const std::vector<Draw>& draws,
                                   const std::vector<UncertaintySource>& sources) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (!campaign.moved(draws, i, true).good || !campaign.moved(draws, i, false).good) {
      names.push_back(sources[i].name);
    }
  }
  return names;
}

}  // namespace

Uncertainty propagate(const Shot& shot, const ReductionOptions& options, const Reduction& reduction,
                      const UncertaintyOptions& wanted, const Workers& workers) {
  Uncertainty result;
  if (!reduction.quality.reducible || reduction.time_s.size() < 2 || wanted.draws < 2) {
    return result;
  }
  ReductionOptions told = options;
  if (!told.bar_model) {
    told.bar_model = shot.bar_model.value_or(paper_pmma());
  }
  result.sources = uncertainty_sources(shot.bench, wanted.bars.value_or(BarPrior(*told.bar_model)));
  if (reduction.separation == Separation::never && reduction.push_left_share > 0.0) {
    result.sources.push_back(hidden_push_source(reduction.push_left_share));
  }
  constexpr double kWider = 1.02;
  const double widest_Hz = widest_band_Hz(shot, told, reduction);
  if (widest_Hz > kWider * reduction.band_limit_Hz) {
    result.sources.push_back(band_limit_source(reduction.band_limit_Hz, widest_Hz));
  }
  const Campaign campaign(wanted.draws, result.sources.size(),
                          NoisyShot(shot, reduction.quiet_samples).has_steps());
  std::vector<Draw> draws(campaign.count());
  workers.run((draws.size() + kChunk - 1) / kChunk, [&](std::size_t chunk, std::size_t) {
    Worker worker(shot, told, reduction, result.sources);
    const std::size_t end = std::min(draws.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      campaign.run(i, wanted.seed, worker, draws[i]);
    }
  });

  const std::vector<Draw> joint(draws.begin(),
                                draws.begin() + static_cast<std::ptrdiff_t>(wanted.draws));
  for (const Draw& draw : joint) {
    (draw.good ? result.draws : result.failed) += 1;
  }
  result.uncounted = uncounted(campaign, draws, result.sources);
  if (result.draws < 2) {
    return result;
  }
  const std::array<Band*, kHistories> bands = {&result.stress_Pa, &result.strain,
                                               &result.strain_rate_per_s, &result.force_front_N,
                                               &result.force_back_N};
  workers.run(kHistories, [&](std::size_t h, std::size_t) {
    *bands[h] = band_of(joint, h, reduction.time_s.size());
  });
  const LoopSummary summary = summarise(reduction);
  if (!summary.no_loading.empty()) {
    return result;
  }
  const Figures nominal = figures_of(summary);
  for (std::size_t f = 0; f < kFigures.size(); ++f) {
    UncertainFigure figure =
        uncertain_figure(kFigures[f].name, nominal[f], figure_values(joint, f));
    const auto noisier = figure_values(campaign.noise_only(draws), f);
    if (kFigures[f].is_extreme && !noisier.empty()) {
      free_of_noise_added(figure, noisier);
    }
    result.figures.push_back(std::move(figure));
  }
  result.budget = budget_of(campaign, draws, result.sources);
  return result;
}

}  // namespace kolsky
