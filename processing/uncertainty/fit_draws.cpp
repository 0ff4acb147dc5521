#include "processing/uncertainty/fit_draws.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "processing/base/error.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/uncertainty/noisy_shot.hpp"
#include "processing/uncertainty/sources.hpp"

namespace kolsky {

namespace {

/// One draw's numbers; no parameters where the search found nothing.
struct Draw {
  std::vector<double> parameters;
  std::vector<double> spectral;
};

/// How shots are identified, with bars of this material.
using Identify = std::function<Draw(const std::vector<Shot>&, const Material& bars)>;

/// Before the pulse has reached any gauge.
std::size_t quiet_samples(const Shot& shot) {
  std::size_t quiet = shot.samples();
  for (const ChannelRecord& channel : shot.channels) {
    const std::vector<double> record(channel.codes.begin(), channel.codes.end());
    if (const auto pulse = first_pulse(record, shot.rate.Hz())) {
      quiet = std::min(quiet, pulse->quiet);
    }
  }
  return quiet;
}

class Repeater {
 public:
  Repeater(const std::vector<Shot>& shots, const BarPrior& bars, Identify identify)
      : shots_(shots),
        bars_(bars.material),
        sources_(uncertainty_sources(shots.front().bench, bars)),
        identify_(std::move(identify)) {
    for (const Shot& shot : shots) {
      quiet_.push_back(quiet_samples(shot));
    }
  }

  [[nodiscard]] Draw draw(RandomStream random) const {
    ShotNumbers numbers{shots_.front().bench, bars_};
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
    try {
      return identify_(recorded, numbers.bars);
    } catch (const InputError&) {
      return {};
    }
  }

 private:
  const std::vector<Shot>& shots_;
  Material bars_;
  std::vector<UncertaintySource> sources_;
  Identify identify_;
  std::vector<std::size_t> quiet_;
};

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

std::vector<UncertainFigure> figures_of(const std::vector<FittedNumber>& numbers,
                                        const std::vector<Draw>& draws,
                                        std::vector<double> Draw::*member) {
  std::vector<UncertainFigure> figures;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::vector<double> values;
    for (const Draw& draw : draws) {
      values.push_back((draw.*member)[i]);
    }
    figures.push_back(uncertain_figure(numbers[i].name, numbers[i].value, std::move(values)));
  }
  return figures;
}

/// @param spectral  empty: not drawn
FitDraws summary(std::vector<Draw> draws, const std::vector<FittedNumber>& parameters,
                 const std::vector<FittedNumber>& spectral) {
  FitDraws result;
  result.failed = std::erase_if(draws, [](const Draw& draw) { return draw.parameters.empty(); });
  result.draws = draws.size();
  if (!draws.empty()) {
    result.parameters = figures_of(parameters, draws, &Draw::parameters);
    result.spectral = figures_of(spectral, draws, &Draw::spectral);
  }
  return result;
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
  const Repeater repeater(
      shots, bars, [&](const std::vector<Shot>& recorded, const Material& moved) {
        BarPrior prior = bars;
        prior.material = moved;
        Draw draw;
        draw.parameters = values_of(fit_specimen(recorded, prior, fitted).parameters);
        if (spectral != nullptr) {
          draw.spectral = values_of(estimate_spectrum(recorded, moved, by_spectrum).parameters);
        }
        return draw;
      });
  return summary(drawn(repeater, options, workers), fit.parameters,
                 spectral != nullptr ? spectral->parameters : std::vector<FittedNumber>());
}

FitDraws draw_bar_fits(const std::vector<Shot>& shots, const BarFit& fit,
                       const FitDrawOptions& options, const Workers& workers) {
  const BarTheory theory{fit.theory, fit.solid, fit.far_end, fit.lossless};
  const Repeater repeater(shots, BarPrior(paper_pmma()),
                          [&](const std::vector<Shot>& recorded, const Material&) {
                            const BarData data = bar_data(recorded, fit.band_limit_Hz, fit.theory);
                            return Draw{values_of(fit_bar(data, theory, fit.at).parameters), {}};
                          });
  return summary(drawn(repeater, options, workers), fit.parameters, {});
}

}  // namespace kolsky
