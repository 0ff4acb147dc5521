#include "tests/hidden_effects/stress_curve.hpp"

#include <algorithm>
#include <cmath>

#include "tests/generators/kelvin_chain.hpp"

namespace kolsky::scoring {

namespace {

constexpr double kLoading_s = 100e-6;  ///< as the waterfall's page says of its curve
constexpr std::size_t kSteps = 16384;  ///< of the march

/// Force over area of a spring that stiffens, in series with a Kelvin chain.
class Material {
 public:
  Material(const testing::TrueSpecimen& specimen, double step_s)
      : stiffening_(specimen.nonlinearity),
        chain_(specimen.chain(), step_s),
        viscous_(chain_.elements().size(), 0.0) {
    for (const auto& element : chain_.elements()) {
      fresh_ += element.from_new;
    }
  }

  double strained_to(double strain) {
    double sprung = strain;
    for (std::size_t k = 0; k < viscous_.size(); ++k) {
      const auto& element = chain_.elements()[k];
      viscous_[k] = element.keep * viscous_[k] + element.from_old * stress_;
      sprung -= viscous_[k];
    }
    const double spring = chain_.glassy_Pa() * (1.0 + stiffening_ * strain);
    stress_ = spring * sprung / (1.0 + spring * fresh_);
    for (std::size_t k = 0; k < viscous_.size(); ++k) {
      viscous_[k] += chain_.elements()[k].from_new * stress_;
    }
    return stress_;
  }

 private:
  double stiffening_;
  testing::KelvinStep chain_;
  std::vector<double> viscous_;
  double fresh_ = 0.0;
  double stress_ = 0.0;
};

}  // namespace

std::vector<double> true_stress_Pa(const testing::TrueSpecimen& specimen,
                                   const std::vector<double>& strain, double loading_s) {
  Material material(specimen, loading_s / static_cast<double>(kSteps));
  std::vector<double> marched{0.0};
  for (std::size_t n = 1; n <= kSteps; ++n) {
    marched.push_back(
        material.strained_to(strain.back() * static_cast<double>(n) / static_cast<double>(kSteps)));
  }
  std::vector<double> stress;
  for (const double own : strain) {
    const double at = own / strain.back() * static_cast<double>(kSteps);
    const auto before = std::min(static_cast<std::size_t>(at), kSteps - 1);
    stress.push_back(
        std::lerp(marched[before], marched[before + 1], at - static_cast<double>(before)));
  }
  return stress;
}

void judge_curve(Verdict& verdict, const Case& drawn, const Answer& waterfall) {
  if (!drawn.campaign.split || waterfall.code != 0 || !waterfall.json.is_object() ||
      waterfall.json.value("steps", nlohmann::json::array()).empty()) {
    return;
  }
  const nlohmann::json curve =
      waterfall.json.at("steps").back().value("curve", nlohmann::json::object());
  if (!curve.contains("strain") || !curve.contains("stress_sd_Pa")) {
    return;
  }
  const auto strain = curve.at("strain").get<std::vector<double>>();
  const auto stress = curve.at("stress_Pa").get<std::vector<double>>();
  const auto sd = curve.at("stress_sd_Pa").get<std::vector<double>>();
  const std::vector<double> truth =
      true_stress_Pa(drawn.campaign.split->specimen, strain, kLoading_s);
  const std::size_t last = strain.size() - 1;
  for (const std::size_t at : {last / 3, 2 * last / 3, last}) {
    if (sd[at] > 0.0) {
      verdict.curve_in_sd.push_back((stress[at] - truth[at]) / sd[at]);
    }
  }
}

}  // namespace kolsky::scoring
