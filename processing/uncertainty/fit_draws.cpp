#include "processing/uncertainty/fit_draws.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <utility>

#include "processing/base/error.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/formatted.hpp"
#include "processing/specimen/fit_warnings.hpp"
#include "processing/uncertainty/noisy_shot.hpp"
#include "processing/uncertainty/sources.hpp"

namespace kolsky {

namespace {

/// One draw's numbers; empty where nothing was found.
struct Draw {
  std::vector<double> fit;
  std::vector<double> spectral;
};

/// How shots are identified, with bars of this material.
using Identify = std::function<Draw(const std::vector<Shot>&, const Material& bars)>;

/// Before the pulse has reached the first of the gauges.
std::size_t quiet_samples(const Shot& shot, const std::vector<std::size_t>& first_gauges) {
  std::size_t quiet = shot.samples();
  for (const std::size_t channel : first_gauges) {
    const auto& codes = shot.channels[channel].codes;
    const std::vector<double> record(codes.begin(), codes.end());
    if (const auto pulse = first_pulse(record, shot.rate.Hz())) {
      quiet = std::min(quiet, std::max(kFewestQuiet, pulse->quiet));
    }
  }
  return quiet;
}

/// What draws move.
enum class Moves { noise, noise_and_bench };

class Repeater {
 public:
  Repeater(const std::vector<Shot>& shots, const std::vector<std::size_t>& first_gauges,
           const BarPrior& bars, Identify identify, Moves moves = Moves::noise_and_bench)
      : shots_(shots), filed_{shots.front().bench, bars.material}, identify_(std::move(identify)) {
    if (moves == Moves::noise_and_bench) {
      sources_ = uncertainty_sources(shots.front().bench, bars);
    }
    for (const Shot& shot : shots) {
      quiet_.push_back(quiet_samples(shot, first_gauges));
    }
  }

  [[nodiscard]] Draw draw(RandomStream random) const {
    ShotNumbers numbers = filed_;
    for (const UncertaintySource& source : sources_) {
      source.move(numbers, random.normal());
    }
    std::vector<Shot> recorded;
    for (std::size_t i = 0; i < shots_.size(); ++i) {
      NoisyShot noisy(shots_[i], quiet_[i]);
      noisy.set_bench(numbers.bench);
      noisy.record(&random);
      recorded.push_back(noisy.shot());
    }
    return identify_(recorded, numbers.bars);
  }

 private:
  const std::vector<Shot>& shots_;
  ShotNumbers filed_;
  std::vector<UncertaintySource> sources_;
  Identify identify_;
  std::vector<std::size_t> quiet_;
};

/// What an estimator finds; nothing where it refuses.
template <class Estimate>
std::vector<double> found_by(Estimate estimate) {
  try {
    return values_of(estimate());
  } catch (const InputError&) {
    return {};
  }
}

std::vector<Draw> drawn(const Repeater& repeater, const FitDrawOptions& options,
                        const Workers& workers) {
  std::vector<Draw> draws(options.draws);
  std::atomic<std::size_t> done = 0;
  workers.run(draws.size(), [&](std::size_t i, std::size_t) {
    draws[i] = repeater.draw(RandomStream(options.seed, i));
    options.progress(++done, draws.size());
  });
  return draws;
}

/// Numbers a hundred times off were not found: nothing in the shots held them.
bool without_bounds(const std::vector<double>& drawn, const std::vector<FittedNumber>& numbers) {
  constexpr double kOff = 100.0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double ratio = drawn[i] / numbers[i].value;
    if (!(ratio < kOff && ratio * kOff > 1.0)) {
      return true;
    }
  }
  return false;
}

/// @param numbers  what draws scatter about; draws may hold more behind them
DrawnNumbers summary(const std::vector<Draw>& draws, std::vector<double> Draw::*member,
                     const std::vector<FittedNumber>& numbers) {
  DrawnNumbers result;
  std::vector<const std::vector<double>*> found;
  for (const Draw& draw : draws) {
    const std::vector<double>& own = draw.*member;
    if (own.empty() || without_bounds(own, numbers)) {
      ++result.failed;
    } else {
      found.push_back(&own);
    }
  }
  result.draws = found.size();
  constexpr std::size_t kMany = 20;
  if (result.draws < kFewestDraws) {
    result.warnings.push_back(formatted("%zu of %zu draws found numbers: too few to state anything",
                                        result.draws, draws.size()));
    return result;
  }
  if (result.failed * kMany > draws.size()) {
    result.warnings.push_back(
        formatted("%zu of %zu draws found no numbers, and are not in these intervals",
                  result.failed, draws.size()));
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::vector<double> values;
    for (const std::vector<double>* own : found) {
      values.push_back((*own)[i]);
    }
    result.figures.push_back(
        uncertain_figure(numbers[i].name, numbers[i].value, std::move(values)));
  }
  return result;
}

/// Says where a fit states more than its draws scatter.
void hold_against(const std::vector<FittedNumber>& stated, DrawnNumbers& drawn) {
  const double more = std::max(1.3, 1.0 + 4.0 / std::sqrt(2.0 * static_cast<double>(drawn.draws)));
  for (std::size_t i = 0; i < drawn.figures.size(); ++i) {
    const UncertainFigure& own = drawn.figures[i];
    if (stated[i].sd > more * own.sd) {
      drawn.warnings.push_back(formatted(
          "the fit states %.2g times as much for %s: with what its model leaves undescribed or "
          "undecided, which draws do not hold",
          stated[i].sd / own.sd, own.name.c_str()));
    }
  }
}

/// As an estimate was made.
SpectralOptions as_estimated(const SpectralEstimate& estimate, WaveTheory bars) {
  SpectralOptions options;
  options.bars = bars;
  options.band_limit_Hz = estimate.band_limit_Hz;
  options.separation = estimate.separation == Separation::equilibrium ? Separation::equilibrium
                                                                      : Separation::as_needed;
  return options;
}

/// How far draws lie from what they scatter about, as logarithms: one that runs away counts as one
/// that is off by a factor of twenty.
double scatter_of_logs(const std::vector<Draw>& draws, std::size_t number, double value) {
  constexpr double kMost = 3.0;
  double squares = 0.0;
  for (const Draw& draw : draws) {
    squares += std::pow(std::min(kMost, std::abs(std::log(draw.spectral[number] / value))), 2);
  }
  return std::sqrt(squares / static_cast<double>(draws.size()));
}

/// Of what loses nothing E1 alone: the rest stands for none.
std::vector<FittedNumber> told_numbers(std::vector<FittedNumber> numbers, bool lossless) {
  numbers.resize(lossless ? 1 : numbers.size());
  return numbers;
}

SpecimenFitOptions as_fitted(const SpecimenFit& fit) {
  SpecimenFitOptions options;
  options.solid = fit.solid;
  options.lossless = fit.lossless;
  options.bars = fit.theory.bars;
  options.specimen = fit.theory.specimen;
  options.band_limit_Hz = fit.band_limit_Hz;
  options.after_foot_s = fit.after_foot_s;
  if (fit.solid == SolidKind::three_element) {
    options.start = values_of(fit.parameters);
  } else if (fit.three_element) {
    options.start = values_of(fit.three_element->parameters);
  }
  return options;
}

}  // namespace

FitDraws draw_specimen_fits(const std::vector<Shot>& shots, const BarPrior& bars,
                            const SpecimenFit& fit, const SpectralEstimate* spectral,
                            const FitDrawOptions& options, const Workers& workers) {
  const SpecimenFitOptions fitted = as_fitted(fit);
  const SpectralOptions by_spectrum =
      spectral != nullptr ? as_estimated(*spectral, fit.theory.bars) : SpectralOptions{};
  const Repeater repeater(
      shots, shpb_stations(shots.front().bench).front().channels, bars,
      [&](const std::vector<Shot>& recorded, const Material& moved) {
        BarPrior prior = bars;
        prior.material = moved;
        Draw draw;
        draw.fit = found_by([&] { return fit_specimen(recorded, prior, fitted).parameters; });
        if (spectral != nullptr) {
          draw.spectral =
              found_by([&] { return estimate_spectrum(recorded, moved, by_spectrum).parameters; });
        }
        return draw;
      });
  const std::vector<Draw> draws = drawn(repeater, options, workers);
  const std::vector<FittedNumber> numbers = told_numbers(fit.parameters, fit.lossless);
  FitDraws result{summary(draws, &Draw::fit, numbers), std::nullopt};
  hold_against(numbers, result.fit);
  if (spectral != nullptr) {
    result.spectral = summary(draws, &Draw::spectral, spectral->parameters);
  }
  return result;
}

void take_in_noise(const std::vector<Shot>& shots, const Material& bars, WaveTheory theory,
                   SpectralEstimate& estimate, const Workers& workers) {
  constexpr std::size_t kDraws = 60;
  const SpectralOptions options = as_estimated(estimate, theory);
  const Repeater repeater(
      shots, shpb_stations(shots.front().bench).front().channels, BarPrior(bars),
      [&](const std::vector<Shot>& recorded, const Material& moved) {
        return Draw{
            {}, found_by([&] { return estimate_spectrum(recorded, moved, options).parameters; })};
      },
      Moves::noise);
  FitDrawOptions drawing;
  drawing.draws = kDraws;
  std::vector<Draw> draws = drawn(repeater, drawing, workers);
  std::erase_if(draws, [](const Draw& draw) { return draw.spectral.empty(); });
  if (draws.size() < kFewestDraws) {
    estimate.warnings.emplace_back(
        "deviations do not hold the gauges' noise: with more of it nothing was found");
    return;
  }
  for (const std::string& said : warnings_of(estimate.parameters)) {
    std::erase(estimate.warnings, said);
  }
  for (std::size_t i = 0; i < estimate.parameters.size(); ++i) {
    FittedNumber& number = estimate.parameters[i];
    number.sd = std::max(number.sd, number.value * scatter_of_logs(draws, i, number.value));
  }
  std::ranges::move(warnings_of(estimate.parameters), std::back_inserter(estimate.warnings));
}

FitDraws draw_bar_fits(const std::vector<Shot>& shots, const BarFit& fit,
                       const FitDrawOptions& options, const Workers& workers) {
  const BarTheory theory{fit.theory, fit.solid, fit.far_end, fit.lossless};
  const Repeater repeater(
      shots, {read_bar_records(shots.front()).channel.front()}, BarPrior(paper_pmma()),
      [&](const std::vector<Shot>& recorded, const Material&) {
        return Draw{found_by([&] {
                      const BarData data = bar_data(recorded, fit.band_limit_Hz, fit.theory);
                      return fit_bar(data, theory, fit.at).parameters;
                    }),
                    {}};
      });
  const std::vector<FittedNumber> numbers = told_numbers(fit.parameters, fit.lossless);
  FitDraws result{summary(drawn(repeater, options, workers), &Draw::fit, numbers), std::nullopt};
  hold_against(numbers, result.fit);
  return result;
}

}  // namespace kolsky
