#include "processing/criticism/fitting/held_out.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <complex>
#include <numeric>
#include <random>

#include "processing/criticism/fitting/branch_order.hpp"
#include "processing/criticism/fitting/record_parts.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

std::vector<Shot> small_campaign(const std::vector<std::string>& effects) {
  testing::CampaignWishes wishes{
      .seed = 911, .shots = 4, .gauges = 3, .samples = 1500, .rate_Hz = 1e6};
  testing::Campaign campaign = testing::draw_campaign(wishes);
  for (const std::string& effect : effects) {
    testing::hide(campaign, testing::parse_effect(effect));
  }
  return testing::shots_of(campaign);
}

/// Shots whose residuals bend with the only free number: the last one by far the most.
class Bent : public ShotResiduals {
 public:
  explicit Bent(double start) : start_(start) {}

  static double one(double off, std::size_t shot, std::size_t i) {
    constexpr std::array kBend{0.4, 0.5, 0.6, 5.0};
    constexpr std::array kAmplitude{1.0, 1.3, -0.7};
    constexpr std::array<std::array<double, 3>, 4> kRecord{
        {{1.9, 2.2, -1.2}, {2.0, 2.9, -1.1}, {2.3, 2.6, -1.6}, {90.0, 110.0, -70.0}}};
    return kAmplitude[i] * std::exp(kBend[shot] * off) - kRecord[shot][i];
  }

  static double square(double off, std::size_t shot) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      sum += one(off, shot, i) * one(off, shot, i);
    }
    return sum;
  }

  Eigen::VectorXd evaluate(const Composition& composition, const std::vector<double>& theta,
                           std::size_t worker) override {
    Eigen::VectorXd all(12);
    for (std::size_t shot = 0; shot < 4; ++shot) {
      all.segment(static_cast<Eigen::Index>(3 * shot), 3) =
          evaluate_shot(composition, theta, shot, worker);
    }
    return all;
  }
  Eigen::VectorXd evaluate_shot(const Composition& /*composition*/,
                                const std::vector<double>& theta, std::size_t shot,
                                std::size_t /*worker*/) override {
    Eigen::VectorXd own(3);
    for (std::size_t i = 0; i < 3; ++i) {
      own[static_cast<Eigen::Index>(i)] = one(theta[0] - start_, shot, i);
    }
    return own;
  }
  [[nodiscard]] std::size_t per_shot() const override { return 3; }

 private:
  double start_;
};

// Against a search over the number by brute force.
TEST(HeldOut, IsExactWhereFirstOrderIsNot) {
  const Campaign campaign = read_campaign(small_campaign({}));
  Model model = paper_model(BenchKind::bar, false);
  for (EffectUse& use : model.effects) {
    for (std::size_t p = 0; p < use.values.size(); ++p) {
      use.values[p].free = use.id() == "three-element-bar" && p == 0;
    }
  }
  const Composition composition(model, campaign);
  ASSERT_EQ(composition.numbers().size(), 1u);
  Bent residuals(composition.start()[0]);
  ModelFit fit = fit_model(composition, residuals, Workers{});
  const Studied studied{model, composition, fit, {}};
  const std::vector<double> exact = held_out_squares(studied, residuals, Workers{});
  const std::vector<double> first_order = held_out_squares(studied, 3);
  double most_wrong = 0.0;
  for (std::size_t left_out = 0; left_out < 4; ++left_out) {
    double best = 0.0;
    double least = 1e300;
    for (double off = -1.0; off < 3.0; off += 1e-4) {
      double sum = 0.0;
      for (std::size_t shot = 0; shot < 4; ++shot) {
        sum += shot == left_out ? 0.0 : Bent::square(off, shot);
      }
      if (sum < least) {
        least = sum;
        best = off;
      }
    }
    const double truth = Bent::square(best, left_out);
    EXPECT_NEAR(exact[left_out], truth, 1.0 + 0.2 * truth) << left_out;
    most_wrong = std::max(most_wrong, std::abs(first_order[left_out] - truth) / truth);
  }
  EXPECT_GT(most_wrong, 0.5);
}

/// A split bar of whose bars no shot says how warm they are, only about.
testing::Campaign unsure_of_warmth(const std::string& effect) {
  testing::Campaign truth = testing::draw_campaign({.seed = 5,
                                                    .shots = 4,
                                                    .gauges = 4,
                                                    .noise_strain = 4e-6,
                                                    .tolerances = testing::Tolerances::filed,
                                                    .samples = 1000,
                                                    .rate_Hz = 5e5,
                                                    .split = true});
  constexpr std::array kWarmer{0.5, -0.4, 0.3, -0.6};
  for (std::size_t i = 0; i < kWarmer.size(); ++i) {
    truth.world.shots[i].temperature_K = truth.world.reference_K + kWarmer[i];
  }
  truth.world.material.per_kelvin = 3e-3;
  truth.bench.temperature_K->sd = 0.4;
  testing::hide(truth, testing::parse_effect(effect));
  return truth;
}

std::vector<Shot> of_unknown_warmth(const testing::Campaign& truth) {
  std::vector<Shot> shots = testing::shots_of(truth);
  for (Shot& shot : shots) {
    shot.meta.erase("temperature_K");
  }
  return shots;
}

// Other shots do not tell how warm the bars were in the one that is left out: fitted to them, its
// warmth went back to what is filed, and whatever bends so much that its folds are fitted was held
// against bars of the wrong moduli.
TEST(HeldOut, LeavesAShotWhatIsItsAlone) {
  const testing::Campaign truth = unsure_of_warmth("specimen-second-relaxation=6e-10,tau=3e-5");
  const Campaign campaign = read_campaign(of_unknown_warmth(truth));
  Study study(campaign, 0.0, Workers{});
  Model model = filed_split_bar(truth);
  model.effects.push_back(use_named("specimen-second-relaxation"));
  for (ModelValue& value : model.effects.back().values) {
    value.free = true;
  }
  const Studied studied = study.fit(model);
  const std::vector<double> squares = held_out_squares(studied, study);
  const double cost = std::accumulate(squares.begin(), squares.end(), 0.0) - studied.fit.chi2;
  EXPECT_GT(cost, 0.0);
  EXPECT_LT(cost, 4.0 * static_cast<double>(studied.fit.theta.size()));
}

// What an amplifier bent is straightened with what the fit leaves: of a model that lacks the
// return of an end that is no noise.
TEST(HeldOut, IsOfAModelsOwnStraightening) {
  testing::Campaign truth = testing::draw_campaign(
      {.seed = 8, .shots = 3, .noise_strain = 6e-6, .samples = 1500, .rate_Hz = 5e5});
  testing::hide(truth, testing::parse_effect("end-reflection=0"));
  testing::hide(truth, testing::parse_effect("bridge-nonlinearity=-60"));
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(study, paper_model(BenchKind::bar, false), {});
  EXPECT_EQ(diagnosis.effects.size(), 2u);
  EXPECT_LT(diagnosis.held_out.after, 1.1 * diagnosis.held_out.floor);
}

/// Spectra, two channels side by side, of columns that are given in time.
Eigen::MatrixXd spectra_of(const Eigen::MatrixXd& times, Eigen::Index bins) {
  const Eigen::Index instants = 2 * bins + 1;
  Eigen::MatrixXd spectra(4 * bins, times.cols());
  for (Eigen::Index column = 0; column < times.cols(); ++column) {
    for (Eigen::Index c = 0; c < 2; ++c) {
      for (Eigen::Index k = 0; k < bins; ++k) {
        std::complex<double> sum;
        for (Eigen::Index n = 0; n < instants; ++n) {
          const double phase = -2.0 * 3.14159265358979323846 * static_cast<double>((k + 1) * n) /
                               static_cast<double>(instants);
          sum += times(c * instants + n, column) * std::polar(1.0, phase);
        }
        sum *= std::sqrt(2.0 / static_cast<double>(instants));
        spectra(2 * (2 * k + c), column) = sum.real();
        spectra(2 * (2 * k + c) + 1, column) = sum.imag();
      }
    }
  }
  return spectra;
}

// Two numbers fitted to the other parts of a record by themselves, in time.
TEST(HeldOutParts, AreWhatAFitToTheOthersForetells) {
  constexpr Eigen::Index kBins = 160;
  constexpr Eigen::Index kInstants = 2 * kBins + 1;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd times(2 * kInstants, 3);  // two columns of derivatives, and a record
  for (double& value : times.reshaped()) {
    value = normal(random);
  }
  for (Eigen::Index c = 0; c < 2; ++c) {
    for (Eigen::Index column = 0; column < 3; ++column) {
      auto part = times.col(column).segment(c * kInstants, kInstants);
      part.array() -= part.mean();  // spectra hold no constant
    }
  }
  times.col(2) += 3.0 * times.col(0) - times.col(1);
  const Eigen::MatrixXd spectra = spectra_of(times, kBins);
  constexpr double kPrior = 5.0;  // of both numbers about 0
  ModelFit fit;
  fit.jacobian = spectra.leftCols(2);
  fit.information =
      fit.jacobian.transpose() * fit.jacobian + kPrior * Eigen::MatrixXd::Identity(2, 2);
  const Eigen::VectorXd best =
      -fit.information.inverse() * (fit.jacobian.transpose() * spectra.col(2));
  fit.theta = {best[0], best[1]};
  fit.residual = spectra.col(2) + fit.jacobian * best;
  const std::vector<double> parts = held_out_parts(fit, 2);
  ASSERT_EQ(parts.size(), kRecordParts);
  for (std::size_t part = 0; part < parts.size(); ++part) {
    std::vector<Eigen::Index> own;
    std::vector<Eigen::Index> others;
    for (Eigen::Index row = 0; row < times.rows(); ++row) {
      const Eigen::Index stretch = (row % kInstants) * 64 / kInstants;
      (stretch % 8 == static_cast<Eigen::Index>(part) ? own : others).push_back(row);
    }
    const Eigen::MatrixXd J = times(others, std::vector<int>{0, 1});
    const Eigen::VectorXd y = times(others, 2);
    const Eigen::MatrixXd normal_matrix =
        J.transpose() * J + kPrior * Eigen::MatrixXd::Identity(2, 2);
    const Eigen::VectorXd at = -normal_matrix.inverse() * (J.transpose() * y);
    const Eigen::MatrixXd J_own = times(own, std::vector<int>{0, 1});
    const double wanted = (times(own, 2) + J_own * at).squaredNorm();
    EXPECT_NEAR(parts[part], wanted, 1e-8 * wanted) << part;
  }
  // What foretells nothing costs more on parts that it did not see than on those it did.
  EXPECT_GT(std::accumulate(parts.begin(), parts.end(), 0.0), fit.residual.squaredNorm());
}

TEST(Certification, CountsWhatFiledNumbersAreRelievedOf) {
  const Certification without = certification({10.0, 12.0}, {10.1, 12.1}, 0.0);
  EXPECT_NEAR(without.gain, -0.2, 1e-12);
  EXPECT_EQ(without.better, 0u);
  const Certification relieved = certification({10.0, 12.0}, {10.1, 12.1}, 40.0);
  EXPECT_NEAR(relieved.gain, 39.8, 1e-12);
  EXPECT_EQ(relieved.better, 2u);
}

// Two shots far from the mean temperature tell how moduli change with it, three near it nothing.
TEST(Certification, CountsAShotForWhatItSaysOfTheEffect) {
  const std::vector<double> before{130.0, 100.0, 100.0, 100.0, 130.0};
  const std::vector<double> after{100.0, 100.4, 100.2, 100.3, 100.0};
  const Certification alike = certification(before, after, 0.0);
  EXPECT_EQ(alike.better, 2u);
  EXPECT_NEAR(alike.share, 0.4, 1e-12);
  const Certification weighed = certification(before, after, 0.0, {4.0, 0.5, 0.0, 0.5, 3.0});
  EXPECT_EQ(weighed.better, 2u);
  EXPECT_NEAR(weighed.share, 7.0 / 8.0, 1e-12);
  // One shot alone that would say it all is not foretold by those that say nothing.
  const Certification lost =
      certification(before, {131.0, 99.0, 99.0, 99.0, 131.0}, 0.0, {4.0, 0.5, 0.0, 0.5, 3.0});
  EXPECT_NEAR(lost.share, 1.0 / 8.0, 1e-12);
  EXPECT_NEAR(certification(before, after, 0.0, std::vector<double>(5, 0.0)).share, 0.4, 1e-12);
}

// The records must not change, only which branch is called further.
TEST(BranchOrder, KeepsTheComplianceAndCallsTheLesserBranchFurther) {
  const Campaign campaign = read_campaign(small_campaign({}));
  Model model = paper_model(BenchKind::bar, false);
  model.effects.push_back(use_named("second-relaxation"));
  for (ModelValue& value : model.effects.back().values) {
    value.free = true;
  }
  const Composition composition(model, campaign);
  const auto value = [&](const std::vector<double>& theta, const std::string& id, std::size_t p) {
    for (std::size_t i = 0; i < theta.size(); ++i) {
      const FreeNumber& number = composition.numbers()[i];
      if (composition.uses()[number.use].id() == id && number.parameter == p) {
        return number.value_at(theta[i]);
      }
    }
    return 0.0;
  };
  const auto compliance = [&](const std::vector<double>& theta, double omega) {
    const std::complex<double> s(0.0, omega);
    return 1.0 / (value(theta, "three-element-bar", 1) + s * value(theta, "three-element-bar", 2)) +
           value(theta, "second-relaxation", 0) / (1.0 + s * value(theta, "second-relaxation", 1));
  };
  std::vector<double> theta = composition.start();
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    if (composition.uses()[number.use].id() == "second-relaxation") {
      theta[i] = number.theta_of(number.parameter == 0 ? 9e-11 : 4e-4);
    }
  }
  const std::vector<double> before = theta;
  EXPECT_TRUE(put_branches_in_order(composition, theta));
  EXPECT_LT(value(theta, "second-relaxation", 0), 9e-11);
  for (const double omega : {1e2, 1e4, 3e5}) {
    EXPECT_LT(std::abs(compliance(theta, omega) - compliance(before, omega)),
              1e-12 * std::abs(compliance(before, omega)));
  }
  EXPECT_FALSE(put_branches_in_order(composition, theta));
}

// A fit that ends with the names the other way round is as good: whoever asks for it again gets
// them in order.
TEST(Study, RefitsWithTheLesserBranchFurther) {
  const Campaign campaign = read_campaign(small_campaign({"second-relaxation=1.5e-11,tau=3e-5"}));
  Model model = paper_model(BenchKind::bar, false);
  model.effects.push_back(use_named("second-relaxation"));
  for (ModelValue& value : model.effects.back().values) {
    value.free = true;
  }
  Study study(campaign, 0.0, Workers{});
  const Studied fitted = study.fit(model);
  const auto places = [&](const std::string& id) {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < fitted.fit.theta.size(); ++i) {
      if (fitted.composition.uses()[fitted.composition.numbers()[i].use].id() == id) {
        out.push_back(i);
      }
    }
    return out;
  };
  const std::vector<std::size_t> own = places("three-element-bar");
  const std::vector<std::size_t> further = places("second-relaxation");
  ASSERT_EQ(own.size(), 3u);
  ASSERT_EQ(further.size(), 2u);
  const auto value = [&](const Studied& studied, std::size_t i) {
    return studied.composition.numbers()[i].value_at(studied.fit.theta[i]);
  };

  Studied renamed = fitted;
  const auto set = [&](std::size_t i, double to) {
    renamed.fit.theta[i] = fitted.composition.numbers()[i].theta_of(to);
  };
  const double E2 = value(fitted, own[1]);
  const double D = value(fitted, further[0]);
  set(further[0], 1.0 / E2);
  set(further[1], value(fitted, own[2]) / E2);
  set(own[1], 1.0 / D);
  set(own[2], value(fitted, further[1]) / D);
  EXPECT_GT(value(renamed, further[0]), D);

  const Studied again = study.refit(renamed);
  EXPECT_NEAR(value(again, further[0]), D, 0.05 * D);
  EXPECT_NEAR(value(again, own[1]), E2, 0.05 * E2);
}

// Its length acts by its square: from nothing a fit must still find it.
TEST(Fit, FindsAGaugesLengthFromNull) {
  const std::vector<Shot> shots = small_campaign({"gauge-length:g2=0.03"});
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, 0.0, Workers{});
  Model model = paper_model(BenchKind::bar, false);
  model.effects.push_back(use_named("gauge-length:g2"));
  model.effects.back().values.front().free = true;
  const Studied studied = study.fit(model);
  const ModelValue& found = studied.model.find("gauge-length:g2")->values.front();
  EXPECT_LT(std::abs(found.value - 0.03), 4.0 * found.sd);
  EXPECT_LT(found.sd, 3e-3);
  EXPECT_NEAR(studied.misfit.chi2_reduced, 1.0, 0.1);
}

}  // namespace
}  // namespace kolsky
