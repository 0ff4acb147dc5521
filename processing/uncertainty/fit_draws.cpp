#include "processing/uncertainty/fit_draws.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "processing/base/error.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/formatted.hpp"
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

class Repeater {
 public:
  Repeater(const std::vector<Shot>& shots, const std::vector<std::size_t>& first_gauges,
           const BarPrior& bars, Identify identify)
      : shots_(shots),
        filed_{shots.front().bench, bars.material},
        sources_(uncertainty_sources(shots.front().bench, bars)),
        identify_(std::move(identify)) {
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

SpecimenFitOptions as_fitted(const SpecimenFit& fit) {
  SpecimenFitOptions options;
  options.solid = fit.solid;
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
  SpectralOptions by_spectrum;
  by_spectrum.bars = fit.theory.bars;
  if (spectral != nullptr) {
    by_spectrum.band_limit_Hz = spectral->band_limit_Hz;
    by_spectrum.separation = spectral->separation == Separation::equilibrium
                                 ? Separation::equilibrium
                                 : Separation::as_needed;
  }
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
  FitDraws result{summary(draws, &Draw::fit, fit.parameters), std::nullopt};
  hold_against(fit.parameters, result.fit);
  if (spectral != nullptr) {
    result.spectral = summary(draws, &Draw::spectral, spectral->parameters);
  }
  return result;
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
  std::vector<FittedNumber> numbers = fit.parameters;
  if (fit.lossless) {
    numbers.resize(1);
  }
  FitDraws result{summary(drawn(repeater, options, workers), &Draw::fit, numbers), std::nullopt};
  hold_against(numbers, result.fit);
  return result;
}

}  // namespace kolsky
