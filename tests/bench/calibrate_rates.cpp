// How often `kolsky calibrate` passes a bench that is filed within its deviations, how often it
// names what is off, and how often its intervals hold the truth:
//   calibrate_rates [--repeats 100] [--seed 7000] [--shots 3] [--samples 2048] [--cases 5]
//   [--silent 0]
// --silent 1: nothing comes back from the far end. Seeds that nothing was chosen on.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "processing/calibration/calibration.hpp"
#include "tests/generators/campaign.hpp"

namespace {

using namespace kolsky;

struct Case {
  const char* name;
  std::vector<std::string> effects;
  std::vector<std::string> guilty;
  double E1_filed = 1.0;  ///< over what it is; 1: bars' moduli are not filed
};

const std::vector<Case> kCases = {
    {"filed within its deviations", {}, {}},
    {"place 5 mm off", {"gauge-position:g3=0.005"}, {"gauge-position:g3"}},
    {"gain 3 % off", {"gauge-factor:g2=0.03"}, {"gauge-factor:g2"}},
    {"gain 3 % off, delay of 2 us",
     {"gauge-factor:g2=0.03", "channel-delay:g4=2e-6"},
     {"gauge-factor:g2", "channel-delay:g4"}},
    {"E1 2 % off", {}, {"E1_Pa"}, 1.02},
};

struct Wishes {
  int repeats = 100;
  std::uint64_t seed = 7000;
  int shots = 3;
  int samples = 2048;
  std::size_t cases = kCases.size();
  bool silent = false;
};

/// How the truth lies within what was stated.
struct Coverage {
  int inside = 0;
  int all = 0;
  double squares = 0.0;

  void add(const Measured& stated, double truth) {
    const double z = (stated.value - truth) / stated.sd;
    inside += std::abs(z) < 1.96 ? 1 : 0;
    squares += z * z;
    ++all;
  }
};

testing::Campaign draw(std::uint64_t seed, const Case& wanted, const Wishes& asked) {
  testing::CampaignWishes wishes{.seed = seed,
                                 .shots = asked.shots,
                                 .tolerances = testing::Tolerances::filed,
                                 .samples = asked.samples,
                                 .rate_Hz = 5e5};
  testing::Campaign made = testing::draw_campaign(wishes);
  if (!asked.silent) {
    testing::hide(made, testing::parse_effect("end-reflection=0"));
  }
  for (const std::string& effect : wanted.effects) {
    testing::hide(made, testing::parse_effect(effect));
  }
  return made;
}

CalibrationOptions options_of(const testing::Campaign& made, const Case& wanted) {
  CalibrationOptions options;
  if (wanted.E1_filed != 1.0) {
    const auto& true_material = made.world.material;
    Material material;
    material.density_kg_m3 = {true_material.density_kg_m3};
    material.poisson_ratio = {true_material.poisson_ratio};
    material.E1_Pa() = {true_material.E1_Pa * wanted.E1_filed, true_material.E1_Pa * 1e-3};
    material.E2_Pa() = {true_material.E2_Pa, true_material.E2_Pa * 1e-2};
    material.eta2_Pa_s() = {true_material.eta2_Pa_s, true_material.eta2_Pa_s * 1e-2};
    options.bars = BarPrior(material);
  }
  return options;
}

void run(const Case& wanted, const Wishes& asked, std::uint64_t seed) {
  int exactly = 0;
  int among = 0;
  int others = 0;
  int doubtful = 0;
  int undecided = 0;
  Coverage gains;
  Coverage places;
  for (int repeat = 0; repeat < asked.repeats; ++repeat) {
    const testing::Campaign made = draw(seed + static_cast<std::uint64_t>(repeat), wanted, asked);
    const Calibration calibration = calibrate(testing::shots_of(made), options_of(made, wanted));
    std::vector<std::string> named;
    bool doubts = false;
    for (const PartResult& part : calibration.parts) {
      for (const CalibratedNumber& number : part.numbers) {
        if (number.standing == Standing::differs || number.standing == Standing::tied) {
          named.push_back(number.id);
        }
        doubts = doubts || number.standing == Standing::doubtful;
        for (const testing::TrueGauge& gauge : made.world.gauges) {
          if (gauge.name == number.gauge && number.of == CalibratedNumber::Of::gain) {
            gains.add(number.combined, gauge.gain);
          } else if (gauge.name == number.gauge && number.of == CalibratedNumber::Of::position) {
            places.add(number.combined, gauge.position_m);
          }
        }
      }
    }
    std::vector<std::string> guilty = wanted.guilty;
    std::sort(guilty.begin(), guilty.end());
    std::sort(named.begin(), named.end());
    exactly += named == guilty ? 1 : 0;
    const bool all = std::includes(named.begin(), named.end(), guilty.begin(), guilty.end());
    among += all && named != guilty ? 1 : 0;
    others += all ? 0 : 1;
    doubtful += doubts ? 1 : 0;
    undecided += calibration.certificate == Certificate::undecided ? 1 : 0;
    if (named != guilty) {
      std::printf("  seed %llu:", static_cast<unsigned long long>(seed) + repeat);
      for (const std::string& id : named) {
        std::printf(" %s", id.c_str());
      }
      std::printf("\n");
    }
  }
  std::printf("%s: %d benches, exactly so %d, with others %d, not %d; doubtful %d, undecided %d\n",
              wanted.name, asked.repeats, exactly, among, others, doubtful, undecided);
  for (const auto& [what, coverage] : {std::pair{"gains", gains}, std::pair{"places", places}}) {
    std::printf("  %s: %d of %d intervals hold the truth, mean square of deviations %.2f\n", what,
                coverage.inside, coverage.all, coverage.squares / coverage.all);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Wishes asked;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    const char* const value = argv[i + 1];
    if (name == "--repeats") {
      asked.repeats = std::atoi(value);
    } else if (name == "--seed") {
      asked.seed = std::strtoull(value, nullptr, 10);
    } else if (name == "--shots") {
      asked.shots = std::atoi(value);
    } else if (name == "--samples") {
      asked.samples = std::atoi(value);
    } else if (name == "--cases") {
      asked.cases = std::min(kCases.size(), static_cast<std::size_t>(std::atoi(value)));
    } else if (name == "--silent") {
      asked.silent = std::atoi(value) != 0;
    } else {
      std::fprintf(stderr,
                   "calibrate_rates [--repeats 100] [--seed 7000] [--shots 3] [--samples 2048] "
                   "[--cases 5] [--silent 0]\n");
      return 2;
    }
  }
  for (std::size_t i = 0; i < asked.cases; ++i) {
    run(kCases[i], asked, asked.seed + i * static_cast<std::uint64_t>(asked.repeats));
  }
  return 0;
}
