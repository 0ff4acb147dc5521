#include "tests/hidden_effects/further_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kolsky::scoring {

namespace {

using testing::Campaign;
using testing::TrueGauge;
using testing::TrueShot;

bool says(const std::string& proposal, const std::string& words) {
  return proposal.find(words) != std::string::npos;
}

// From a third of today's amplitudes to three times; a specimen must not be crushed.
void vary_amplitudes(Campaign& campaign) {
  auto& shots = campaign.world.shots;
  const double most = campaign.split ? 1.0 : 3.0;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(shots.size() - 1);
    const double factor = std::pow(3.0 * most, share) / 3.0;
    shots[i].peak_strain *= factor;
    for (double& bell : shots[i].source) {
      bell *= campaign.split ? factor : 1.0;
    }
  }
  campaign.full_scale_strain *= most;
}

void vary_temperatures(Campaign& campaign) {
  auto& shots = campaign.world.shots;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(shots.size() - 1);
    shots[i].temperature_K = campaign.world.reference_K + 10.0 * (share - 0.5);
  }
}

// In time, from its foot on.
void stretch_pulses(Campaign& campaign, double factor) {
  for (TrueShot& shot : campaign.world.shots) {
    const std::vector<double> before = shot.source;
    const double top = *std::ranges::max_element(before);
    const auto foot = static_cast<std::size_t>(
        std::ranges::find_if(before, [&](double bell) { return bell > 1e-3 * top; }) -
        before.begin());
    for (std::size_t k = foot; k < before.size(); ++k) {
      const double at = static_cast<double>(foot) + static_cast<double>(k - foot) / factor;
      const auto low = static_cast<std::size_t>(at);
      const double part = at - static_cast<double>(low);
      shot.source[k] =
          low + 1 < before.size() ? (1.0 - part) * before[low] + part * before[low + 1] : 0.0;
    }
  }
}

void add_gauge(Campaign& campaign, bool far) {
  std::vector<double> places;
  for (const TrueGauge& gauge : campaign.world.gauges) {
    if (gauge.bar == "input") {
      places.push_back(gauge.position_m);
    }
  }
  std::ranges::sort(places);
  double place = 0.5 * (places.front() + campaign.world.length_m);
  if (far) {
    place = std::min(places.back() + 0.4, campaign.world.length_m - 0.05);
  } else if (places.size() > 1) {
    place = 0.5 * (places.front() + places.back());
  }
  TrueGauge gauge;
  gauge.name = "g" + std::to_string(campaign.world.gauges.size() + 1);
  gauge.bar = "input";
  gauge.position_m = std::round(place * 1e3) * 1e-3;
  Gauge filed = campaign.bench.gauges.front();
  filed.name = gauge.name;
  filed.bar = "input";
  filed.position_m.value = gauge.position_m;
  campaign.world.gauges.push_back(gauge);
  campaign.bench.gauges.push_back(filed);
  for (TrueShot& shot : campaign.world.shots) {
    shot.offset.push_back(10e-6);
  }
}

// "in 24 shots", "24 shots like these": the shots there are, over again.
std::size_t shots_asked(const std::string& proposal) {
  const std::size_t words = proposal.find(" shots");
  if (words == std::string::npos) {
    return 0;
  }
  const std::size_t before = proposal.rfind(' ', words - 1);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return static_cast<std::size_t>(std::atoi(proposal.substr(first, words - first).c_str()));
}

void repeat_shots(Campaign& campaign, std::size_t count) {
  auto& shots = campaign.world.shots;
  const std::size_t there = shots.size();
  for (std::size_t i = there; i < count; ++i) {
    const TrueShot again = shots[i % there];
    shots.push_back(again);
  }
  campaign.wishes.shots = static_cast<int>(shots.size());
}

}  // namespace

std::optional<Campaign> changed_as_proposed(const Campaign& campaign, const std::string& proposal) {
  Campaign changed = campaign;
  changed.wishes.seed += 1;
  bool made = false;
  const auto make = [&](const std::string& words, const auto& change) {
    if (says(proposal, words)) {
      change();
      made = true;
    }
  };
  make("series of amplitudes", [&] { vary_amplitudes(changed); });
  make("temperature", [&] { vary_temperatures(changed); });
  make("further gauge", [&] { add_gauge(changed, says(proposal, "larger distance")); });
  make("shorter striker", [&] { stretch_pulses(changed, 0.5); });
  make("longer striker", [&] { stretch_pulses(changed, 1.8); });
  if (const std::size_t asked = shots_asked(proposal); asked > changed.world.shots.size()) {
    repeat_shots(changed, asked);
    made = true;
  }
  return made ? std::optional(changed) : std::nullopt;
}

}  // namespace kolsky::scoring
