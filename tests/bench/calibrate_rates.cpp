// How often `kolsky calibrate` passes a bench that is filed within its deviations, and how often it
// names what is off: calibrate_rates [--repeats 100] [--seed 7000]. Seeds that nothing was chosen
// on.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
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

testing::Campaign draw(std::uint64_t seed, const Case& wanted) {
  testing::CampaignWishes wishes;
  wishes.seed = seed;
  wishes.shots = 3;
  wishes.samples = 2048;
  wishes.rate_Hz = 5e5;
  wishes.tolerances = testing::Tolerances::filed;
  testing::Campaign made = testing::draw_campaign(wishes);
  testing::hide(made, testing::parse_effect("end-reflection=0"));
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
    material.E1_Pa = {true_material.E1_Pa * wanted.E1_filed, true_material.E1_Pa * 1e-3};
    material.E2_Pa = {true_material.E2_Pa, true_material.E2_Pa * 1e-2};
    material.eta2_Pa_s = {true_material.eta2_Pa_s, true_material.eta2_Pa_s * 1e-2};
    options.bars = BarPrior(material);
  }
  return options;
}

void run(const Case& wanted, int repeats, std::uint64_t seed) {
  int exactly = 0;
  int among = 0;
  int others = 0;
  int doubtful = 0;
  int undecided = 0;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const testing::Campaign made = draw(seed + static_cast<std::uint64_t>(repeat), wanted);
    const Calibration calibration = calibrate(testing::shots_of(made), options_of(made, wanted));
    std::vector<std::string> named;
    bool doubts = false;
    for (const PartResult& part : calibration.parts) {
      for (const CalibratedNumber& number : part.numbers) {
        if (number.standing == Standing::differs || number.standing == Standing::tied) {
          named.push_back(number.id);
        }
        doubts = doubts || number.standing == Standing::doubtful;
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
              wanted.name, repeats, exactly, among, others, doubtful, undecided);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  int repeats = 100;
  std::uint64_t seed = 7000;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--repeats") == 0) {
      repeats = std::atoi(argv[i + 1]);
    } else if (std::strcmp(argv[i], "--seed") == 0) {
      seed = std::strtoull(argv[i + 1], nullptr, 10);
    } else {
      std::fprintf(stderr, "calibrate_rates [--repeats 100] [--seed 7000]\n");
      return 2;
    }
  }
  for (const Case& wanted : kCases) {
    run(wanted, repeats, seed);
    seed += static_cast<std::uint64_t>(repeats);
  }
  return 0;
}
