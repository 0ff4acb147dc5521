#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "processing/identification/bar_judge.hpp"
#include "processing/identification/bar_misfit.hpp"
#include "processing/identification/bar_model.hpp"
#include "processing/identification/noise_arrivals.hpp"
#include "processing/identification/noise_in_sums.hpp"
#include "processing/identification/wide_products.hpp"

namespace kolsky {

/// What one shot says of the parameters: its sum of squares, half the gradient of that, and the
/// information they bear on.
struct ShotTerms {
  double chi2 = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

/// How likely the gauge records of a bar's shots are under a model of it.
///
/// Each shot's source, the right-going wave at the impacted end, is free at all times, so nothing
/// is assumed of the striker or of what that end does. It is eliminated exactly,
///     r_j(t) = y_j - g_j y_0,      j = 1 .. gauges - 1,
/// which is causal (see BarData) and under the model noise alone. Its covariance at each frequency,
/// diag(p_j) + p_0 g g^H with p the noise's power, follows the parameters: the whitened sum of
/// squares is then that with the source at its own best fit, and so is the gradient, in which y_0
/// gives way to the best estimate of what gauge 0 would show without noise,
/// y_0 + p_0 g^H C^-1 r. Noise of gauge 0 reaches the others through the far end too, but only as
/// far as the record is long, so that it is not steady: g g^H is averaged over its moments, each
/// with the arrivals that there is time for (see NoiseArrivals), and in the lowest bins, which that
/// ties to each other and where a bar's retardation shows, the covariance is that of the record's
/// own length. That covariance also holds what slow noise does within a record, and the error that
/// noise of the quiet samples makes of y_0's baseline; in the other bins these are a baseline of
/// y_0 and a jump between the ends of each r_j, unknown as the noise leaves them, which are
/// eliminated.
class BarLikelihood {
 public:
  /// @param data outlives this
  BarLikelihood(const BarData& data, BarModel model);

  [[nodiscard]] const BarModel& model() const { return model_; }
  [[nodiscard]] const BarData& data() const { return data_; }
  /// Real numbers that are judged.
  [[nodiscard]] std::size_t residuals() const;

  /// The noise's weights as they are at a place in the parameters. They follow it slowly, so a
  /// search may keep them. @param together  the lowest bins by their common covariance, else bin by
  /// bin
  struct Whitening;
  using Weights = std::shared_ptr<const Whitening>;
  [[nodiscard]] Weights weights_at(std::span<const double> at, bool together) {
    return weights_at(at, together, data_.noise());
  }
  [[nodiscard]] Weights weights_at(std::span<const double> at, bool together,
                                   const BarNoise& noise);
  void use(Weights weights) { weights_ = std::move(weights); }
  [[nodiscard]] const Weights& weights() const { return weights_; }

  /// Which shots are looked at: all of them, those of their combinations that hold more than noise,
  /// or what they have in common as one (see BarData), or records of noise alone that were drawn.
  enum class Shots { each, telling, as_one, noise_alone };
  [[nodiscard]] std::size_t count_of(Shots which) const;

  /// What the shots' chi2 add up to at a place in the parameters.
  [[nodiscard]] double chi2_at(std::span<const double> at, Shots which);
  /// What noise adds to the gradient of one shot by itself, on average over records of noise alone:
  /// its square, which does not vanish where the weights leave out how the far end ties the bins.
  /// Changes the place looked at last.
  [[nodiscard]] Eigen::VectorXd gradient_of_noise_alone(std::span<const double> at);
  /// What is left of a wave that has come back once, half way up the band.
  [[nodiscard]] double left_of_a_return(std::span<const double> at);

  /// One per shot, at the place looked at last: near it, half of chi2 moves by
  /// gradient . step + step . information . step / 2.
  [[nodiscard]] std::vector<ShotTerms> terms();

  /// The gauges' noise as the residuals show it at the place looked at last, every shot by itself,
  /// beside the quiet samples: a few hundred of these say little of slow noise. Only what the shots
  /// do not have in common counts, in which what the model lacks hardly shows and on which its
  /// parameters hardly bear. Nothing where that is the noise that the weights have, and of a
  /// single shot, of which noise and what the model lacks cannot be told apart.
  [[nodiscard]] std::optional<BarNoise> noise_by_residuals();

  /// What is left at the place looked at last, every shot by itself, in what the weights take for
  /// noise.
  [[nodiscard]] std::vector<OctaveLeft> left_over();
  /// As how many independent numbers the noise scatters in an octave at the place looked at last,
  /// without what whitening bin by bin leaves out. @param octave  of what `left_over` gives
  [[nodiscard]] double independent_numbers(std::size_t octave);
  /// How the gradient's sum over the shots looked at last scatters.
  struct Scatter {
    Eigen::MatrixXd by_noise;  ///< the gauges'
    Eigen::MatrixXd beyond;    ///< by more power than the weights reckon with
  };
  /// @param as_it_is  of so many shots the noise is taken as it is: what the weights take it for,
  ///   which does for the others, leaves out how the far end ties bins above the lowest
  /// @param power  what there is beyond, by octave, in what the weights take for noise
  [[nodiscard]] Scatter scatter_of_gradient(std::size_t as_it_is, const std::vector<double>& power);

 private:
  using Spectrum = BarData::Spectrum;

  /// A place in the parameters, and what is common to the shots there.
  struct Place {
    std::vector<double> at;
    std::optional<BarModel::Transfers> transfers;  ///< on the damped path
    std::optional<BarModel::Transfers> passages;   ///< on the imaginary axis
    std::vector<std::size_t> shots;
    std::vector<std::vector<Spectrum>> residuals;  ///< by shot and gauge
    std::vector<double> chi2;                      ///< by shot
    EightColumns white_residuals{0, 0};            ///< a column a shot
    EightColumns nuisances{0, 0};                  ///< white
  };

  /// Of a shot, a combination of them or, after those, of noise alone.
  [[nodiscard]] const Spectrum& damped_of_first(std::size_t shot) const;
  [[nodiscard]] const Spectrum& judged_of(std::size_t shot, std::size_t gauge) const;
  [[nodiscard]] std::size_t first_of(Shots which) const;
  [[nodiscard]] Eigen::Index others() const {
    return static_cast<Eigen::Index>(data_.gauges()) - 1;
  }
  /// Real parts of all gauges before imaginary ones, bin after bin.
  [[nodiscard]] Eigen::Index rows() const;
  /// What gauge 0's noise shows at the others, by bin.
  [[nodiscard]] std::vector<NoiseArrivals::Shown> echoes(std::span<const double> at);
  [[nodiscard]] Whitening whitening(std::span<const double> at, BarNoise noise);
  [[nodiscard]] std::vector<std::vector<Complex>> along_waves(
      const std::vector<NoiseArrivals::Shown>& echoes) const;
  [[nodiscard]] std::vector<Eigen::MatrixXcd> scatter_of_residuals(
      const std::vector<NoiseArrivals::Shown>& echoes) const;
  [[nodiscard]] std::vector<NoiseSpectrum::Seen> expected_noise(
      const BarNoise& noise, const std::vector<NoiseArrivals::Shown>& echoes,
      const std::vector<Eigen::MatrixXcd>& scatter) const;
  [[nodiscard]] std::vector<std::vector<double>> responses_to_first(std::span<const double> at);
  [[nodiscard]] NoiseInSums noise_in_sums();
  [[nodiscard]] std::vector<Eigen::MatrixXcd> unwhitened(Eigen::MatrixXd white) const;
  void put(std::span<const Complex> spectrum, Eigen::Index gauge, Eigen::Index column,
           std::size_t first_bin, EightColumns& columns) const;
  void whiten(EightColumns& columns) const;
  void whiten_above_lowest(EightColumns& columns) const;
  void look_at_nuisances();
  void look_at_residuals();
  /// How the gauges follow the parameters there.
  struct Slopes {
    std::vector<std::vector<BarModel::Derivative>> transfers;
    std::vector<std::vector<BarModel::Derivative>> passages;
  };
  void put_slopes(std::size_t index, const Slopes& slopes, EightColumns& columns);
  [[nodiscard]] ShotTerms terms_of(std::size_t index, const Slopes& slopes, EightColumns& columns);
  [[nodiscard]] Slopes slopes() const;
  [[nodiscard]] Eigen::MatrixXd without_nuisances(const EightColumns& columns,
                                                  Eigen::Index count) const;
  /// The first bin of each octave, the lowest of two, and one beyond the last.
  [[nodiscard]] std::vector<std::size_t> octaves() const;
  [[nodiscard]] Eigen::Index first_row(std::size_t bin) const {
    return 2 * others() * static_cast<Eigen::Index>(bin);
  }

  const BarData& data_;
  BarJudge judge_;
  BarModel model_;
  Weights weights_;
  std::vector<BarData::Spectra> noise_alone_;
  Place place_;
};

/// What whitens the residuals, and what estimates gauge 0's noise from them, by bin.
struct BarLikelihood::Whitening {
  BarNoise noise;
  std::vector<Complex> lower_inverse;   ///< triangles, row by row: rows of unit variance each
  std::vector<Complex> noise_of_first;  ///< p_0 g^H C^-1, gauge by gauge
  std::size_t lowest_bins = 0;          ///< which are taken together
  LowerTriangle lowest_factor;          ///< of their rows
};

}  // namespace kolsky
