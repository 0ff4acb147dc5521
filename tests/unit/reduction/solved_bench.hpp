#pragma once

#include <string>
#include <vector>

#include "drivers/simulated/bench_model.hpp"
#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

// Split bars solved in the time domain, on a staggered grid with an internal strain per cell (the
// simulated digitiser's model), as the tests of the reduction share them. The reduction works with
// transforms.
namespace kolsky::testing {

inline constexpr double kStep_s = 0.1e-6;
inline constexpr double kPeriod_s = 1e-6;
inline constexpr std::size_t kPreSamples = 400;

inline constexpr RodMaterial kPmma{
    .density_kg_m3 = 1180, .E1_Pa = 5.66e9, .E2_Pa = 37.0e9, .eta2_Pa_s = 1.81e6};
inline constexpr RodMaterial kCore{
    .density_kg_m3 = 1140, .E1_Pa = 121e6, .E2_Pa = 143e6, .eta2_Pa_s = 2860};
inline constexpr RodMaterial kCover{
    .density_kg_m3 = 960, .E1_Pa = 987e6, .E2_Pa = 452e6, .eta2_Pa_s = 6020};
inline constexpr RodMaterial kAluminium{.density_kg_m3 = 2700, .E1_Pa = 70e9};
inline constexpr RodMaterial kTitanium{.density_kg_m3 = 4430, .E1_Pa = 113e9};
inline constexpr RodMaterial kFoam{.density_kg_m3 = 300, .E1_Pa = 60e6};
inline constexpr RodMaterial kRubber{.density_kg_m3 = 1100, .E1_Pa = 100e6};

[[nodiscard]] double circle_m2(double diameter_m);

/// What the gauges of a solved bench read, sampled, and what happened in its specimen.
struct BenchRecords {
  std::vector<std::vector<double>> strains;
  SpecimenHistory truth;
};
/// @param record_s  from the impact on
[[nodiscard]] BenchRecords records_of(const BenchModel& model, double record_s);

/// The bench file's contents of such a model: gauges g1, g2, ... in its order, samples of strain.
[[nodiscard]] Bench bench_of(const BenchModel& model);

struct SolvedShot {
  Shot shot;
  SpecimenHistory truth;
  double front_arrival_s = 0.0;  ///< of the very front at interface A, on the shot's clock
};
[[nodiscard]] SolvedShot shot_of(const BenchModel& model, const BenchRecords& records,
                                 double noise_rms = 0.0, double range_strain = 0.01,
                                 unsigned seed = 1);

/// Largest difference as a share of the truth's largest value, on the record's own clock.
[[nodiscard]] double worst(const Reduction& r, const std::vector<double>& reduced,
                           const SolvedShot& solved, const std::vector<double>& exact);

/// @throws std::out_of_range where it was not judged
[[nodiscard]] const Check& check_of(const Reduction& r, const std::string& name);

}  // namespace kolsky::testing
