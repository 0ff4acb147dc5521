#include "processing/separation/separation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/accuracy/table.hpp"

namespace kolsky::accuracy {
namespace {

constexpr double kSteelModulus = 206e9;
constexpr double kSteelDensity = 7850.0;
constexpr double kToSpecimen = 0.25;

using Columns = std::map<std::string, std::vector<double>>;

Columns read_table(const std::filesystem::path& path) {
  Columns columns;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::vector<std::string> names;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) {
    names.push_back(name);
  }
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::size_t i = 0;
    for (std::string cell; i < names.size() && std::getline(cells, cell, ','); ++i) {
      columns[names[i]].push_back(cell.empty() ? 0.0 : std::strtod(cell.c_str(), nullptr));
    }
  }
  return columns;
}

std::vector<double> at_even_steps(const std::vector<double>& time_s,
                                  const std::vector<double>& value, double step_s) {
  std::vector<double> even;
  std::size_t n = 0;
  for (double t = time_s.front(); t <= time_s.back(); t += step_s) {
    while (n + 2 < time_s.size() && time_s[n + 1] < t) {
      ++n;
    }
    const double share = (t - time_s[n]) / (time_s[n + 1] - time_s[n]);
    even.push_back(value[n] + share * (value[n + 1] - value[n]));
  }
  return even;
}

/// Rms of the difference over the rms of the truth, in per cent.
std::string off(const std::vector<double>& found, const std::vector<double>& truth) {
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t n = 0; n < std::min(found.size(), truth.size()); ++n) {
    difference += std::pow(found[n] - truth[n], 2);
    size += std::pow(truth[n], 2);
  }
  return fmt::format("{:.2f}", 100.0 * std::sqrt(difference / size));
}

struct Set {
  const char* folder;
  double length_m, diameter_m;
  double specimen_length_m, specimen_diameter_m;
  double step_s;
  double density_kg_m3;  ///< the specimen's, of a handbook; 0 where it cannot be known
  bool keeps_volume;     ///< the specimen; else it keeps its section
};

/// What both bars' records give, and what the finite elements and the tool had, at even steps.
struct Histories {
  SeparatedWaves input, output;
  std::vector<double> input_gauge, input_velocity, output_velocity;
  std::vector<double> stress, strain, ends_strain;
  std::vector<double> tool_input_velocity, tool_output_velocity, tool_stress, tool_strain;
  std::size_t loaded =
      0;  ///< samples until the specimen, past its peak, carries less than a tenth of it
  std::size_t first_loaded = 0;  ///< the same of the first loading
};

Bar bar_of(const Set& set) {
  Bar bar;
  bar.length_m = {set.length_m};
  bar.diameter_m = {set.diameter_m};
  bar.density_kg_m3 = {kSteelDensity};
  bar.poisson_ratio = {0.3};
  return bar;
}

double area_ratio(const Set& set) {
  return std::pow(set.diameter_m / set.specimen_diameter_m, 2);
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) {
    value *= factor;
  }
  return values;
}

std::vector<double> shortened(const std::vector<double>& values, std::size_t size) {
  return {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size)};
}

/// Strain from the velocities of a specimen's ends.
std::vector<double> strain_between(const std::vector<double>& front,
                                   const std::vector<double>& back, const Set& set) {
  std::vector<double> strain(front.size(), 0.0);
  for (std::size_t n = 1; n < front.size(); ++n) {
    const double rate = (front[n] - back[n] + front[n - 1] - back[n - 1]) / 2.0;
    strain[n] = strain[n - 1] + rate * set.step_s / set.specimen_length_m;
  }
  return strain;
}

/// Mean over a specimen that is uniformly strained: the back's stress and what its own mass takes,
/// rho h (a_front / 6 + a_back / 3).
std::vector<double> with_inertia(const std::vector<double>& back, const SeparatedWaves& input,
                                 const SeparatedWaves& output, const Set& set) {
  std::vector<double> mean = back;
  for (std::size_t n = 1; n + 1 < mean.size(); ++n) {
    const auto acceleration = [&](const std::vector<double>& velocity) {
      return (velocity[n + 1] - velocity[n - 1]) / (2.0 * set.step_s);
    };
    mean[n] +=
        set.density_kg_m3 * set.specimen_length_m *
        (acceleration(input.velocity_m_per_s) / 6.0 + acceleration(output.velocity_m_per_s) / 3.0);
  }
  return mean;
}

/// Samples until the stress, once a fifth of its largest, falls below a tenth of what it had.
std::size_t first_release(const std::vector<double>& stress) {
  const double largest = *std::max_element(stress.begin(), stress.end());
  double most = 0.0;
  for (std::size_t n = 0; n < stress.size(); ++n) {
    most = std::max(most, stress[n]);
    if (most > 0.2 * largest && stress[n] < 0.1 * most) {
      return n;
    }
  }
  return stress.size();
}

Histories histories(const Set& set, const std::filesystem::path& folder) {
  const Columns records = read_table(folder / "gauge_strain_records.csv");
  const Columns tool = read_table(folder / "stress_strain_rate.csv");
  const Columns waves = read_table(folder / "wave_separation.csv");
  const auto even = [&](const Columns& columns, const std::string& name) {
    return at_even_steps(columns.at("time_s"), columns.at(name), set.step_s);
  };
  const Bar bar = bar_of(set);
  const ElasticSolid solid(kSteelModulus);
  // What the reduction allows itself of a noiseless record.
  const double band_Hz = 0.2 / set.step_s;
  const auto gauge2 = even(records, "gauge2_transmission_bar_strain");
  Histories all;
  all.input_gauge = even(records, "gauge1_incident_bar_strain");
  all.output = WaveSeparation(bar, solid, WaveTheory::exact, {{kToSpecimen, gauge2, 0.0}},
                              {.start = false, .end = true}, set.step_s, band_Hz)
                   .at(0.0);
  // Equilibrium: the specimen presses on both bars alike, and they are of one diameter.
  all.input =
      WaveSeparation(bar, solid, WaveTheory::exact,
                     {{set.length_m - kToSpecimen, all.input_gauge, 0.0},
                      {set.length_m, all.output.stress_Pa, 0.0, SeparationRecord::mean_stress_Pa}},
                     {}, set.step_s, band_Hz)
          .at(set.length_m);
  all.input_velocity = scaled(even(records, "incident_end_mean_v3_mm_per_s"), 1e-3);
  all.output_velocity = scaled(even(records, "transmitted_end_mean_v3_mm_per_s"), 1e-3);
  all.ends_strain = strain_between(all.input_velocity, all.output_velocity, set);
  all.stress = scaled(even(records, "specimen_mean_compressive_s33_MPa"), 1e6);
  const auto log_strain = even(records, "specimen_mean_compressive_le33");
  for (std::size_t n = 0; n < all.stress.size(); ++n) {
    all.strain.push_back(1.0 - std::exp(-log_strain[n]));
    all.stress[n] *= set.keeps_volume ? std::exp(log_strain[n]) : 1.0;
  }
  const auto peak = std::max_element(all.stress.begin(), all.stress.end());
  const auto released =
      std::find_if(peak, all.stress.end(), [&](double stress) { return stress < 0.1 * *peak; });
  all.loaded = static_cast<std::size_t>(released - all.stress.begin());
  all.first_loaded = first_release(all.stress);
  const double c = std::sqrt(kSteelModulus / kSteelDensity);
  const auto tool_velocity = [&](const std::string& end) {
    auto right = even(waves, end + "_right_going");
    const auto left = even(waves, end + "_left_going");
    for (std::size_t n = 0; n < right.size(); ++n) {
      right[n] = c * (right[n] - left[n]);
    }
    return right;
  };
  all.tool_input_velocity = tool_velocity("incident_end");
  all.tool_output_velocity = tool_velocity("transmitted_end");
  all.tool_stress = scaled(even(tool, "engineering_stress_MPa"), 1e6);
  all.tool_strain = even(tool, "engineering_strain");
  return all;
}

/// What the output bar was given until the specimen let go, off what it then moves with [%].
struct Impulses {
  std::string ours, specimen;
};

Impulses impulses(const Set& set, const Histories& all) {
  const auto passages = static_cast<std::size_t>(
      std::lround(2.0 * set.length_m / std::sqrt(kSteelModulus / kSteelDensity) / set.step_s));
  const std::size_t end = all.loaded + all.loaded / 20;
  double momentum = 0.0;
  for (std::size_t n = end; n < end + passages; ++n) {
    momentum +=
        kSteelDensity * set.length_m * all.output_velocity[n] / static_cast<double>(passages);
  }
  double ours = 0.0;
  double specimen = 0.0;
  for (std::size_t n = 0; n < end; ++n) {
    ours += all.output.stress_Pa[n] * set.step_s;
    specimen += all.stress[n] / area_ratio(set) * set.step_s;
  }
  return {fmt::format("{:+.2f}", 100.0 * (ours / momentum - 1.0)),
          fmt::format("{:+.2f}", 100.0 * (specimen / momentum - 1.0))};
}

/// The input bar's motion from the area under its gauge alone, without separating anything, off
/// that of its end [%]. With e = P + Q at the gauge and Q = F / EA - P at the end, a passage tau
/// away,
///   integral of v from t - tau to t + tau = c (2 integral of (e - F / EA) to t - integral of
///   F / EA over the same),
/// of which the gauge has seen all once t is four passages after the pulse came.
std::string motion_from_area(const Set& set, const Histories& all) {
  const double c = std::sqrt(kSteelModulus / kSteelDensity);
  const double tau_s = kToSpecimen / c;
  const auto passage = static_cast<std::size_t>(std::lround(tau_s / set.step_s));
  const auto sum = [&](const std::vector<double>& values) {
    std::vector<double> area{0.0};
    for (const double value : values) {
      area.push_back(area.back() + value * set.step_s);
    }
    return area;
  };
  const auto strain = sum(all.input_gauge);
  const auto force = sum(scaled(all.output.stress_Pa, 1.0 / kSteelModulus));
  const auto motion = sum(all.input_velocity);
  const double largest = *std::max_element(all.input_gauge.begin(), all.input_gauge.end());
  const auto arrival =
      static_cast<std::size_t>(std::find_if(all.input_gauge.begin(), all.input_gauge.end(),
                                            [&](double value) { return value > 0.05 * largest; }) -
                               all.input_gauge.begin());
  const double even = tau_s / (static_cast<double>(passage) * set.step_s);
  double found = 0.0;
  double truth = 0.0;
  for (std::size_t n = arrival + 4 * passage; n < arrival + 7 * passage; ++n) {
    const double lost = force[n + passage] - force[n - passage];
    found += c * (2.0 * (strain[n] - force[n - passage]) - lost * even);
    truth += (motion[n + passage] - motion[n - passage]) * even;
  }
  return fmt::format("{:+.1f}", 100.0 * (found / truth - 1.0));
}

/// The area of the first pulse under the input bar's gauge, until anything is back from the struck
/// end, as every second sample gives it, off that of all [%]: what the sampling by itself may cost.
std::string area_by_half_the_samples(const Set& set, const Histories& all) {
  const auto& strain = all.input_gauge;
  const double largest = *std::max_element(strain.begin(), strain.end());
  const auto foot = std::find_if(strain.begin(), strain.end(),
                                 [&](double value) { return value > 0.01 * largest; });
  const double back_s =
      2.0 * (set.length_m - kToSpecimen) / std::sqrt(kSteelModulus / kSteelDensity);
  const auto end = static_cast<std::size_t>(foot - strain.begin()) +
                   static_cast<std::size_t>(0.95 * back_s / set.step_s);
  std::array<double, 2> area{};
  for (std::size_t n = 0; n < end; ++n) {
    area.at(n % 2) += strain[n];
  }
  return fmt::format("{:.1f}", 100.0 * std::abs(area[0] - area[1]) / (area[0] + area[1]));
}

/// Its section grows as exp(2 nu e), e the largest logarithmic strain so far: the nu at which the
/// specimen's own mean is nearest to the force.
std::pair<double, std::string> widening(const Histories& all, const std::vector<double>& force) {
  std::pair<double, std::string> best{0.0, ""};
  double least = 1e300;
  for (double nu = 0.0; nu < 0.05; nu += 0.001) {
    double largest = 0.0;
    std::vector<double> stress;
    for (std::size_t n = 0; n < all.loaded; ++n) {
      largest = std::max(largest, -std::log(1.0 - all.strain[n]));
      stress.push_back(all.stress[n] * std::exp(2.0 * nu * largest));
    }
    const std::string text = off(shortened(force, all.loaded), stress);
    if (std::stod(text) < least) {
      least = std::stod(text);
      best = {nu, text};
    }
  }
  return best;
}

void add(const Set& set, const std::filesystem::path& folder, Section& section) {
  const Histories all = histories(set, folder);
  const auto row_until = [&](std::size_t end, const std::string& quantity,
                             const std::vector<double>& ours, const std::vector<double>& tool,
                             const std::vector<double>& truth) {
    section.rows.push_back({set.folder, quantity, off(shortened(ours, end), shortened(truth, end)),
                            off(shortened(tool, end), shortened(truth, end))});
  };
  const auto row = [&](const std::string& quantity, const std::vector<double>& ours,
                       const std::vector<double>& tool, const std::vector<double>& truth) {
    row_until(all.loaded, quantity, ours, tool, truth);
  };
  row("output bar's end, velocity", all.output.velocity_m_per_s, all.tool_output_velocity,
      all.output_velocity);
  row("input bar's end, velocity", all.input.velocity_m_per_s, all.tool_input_velocity,
      all.input_velocity);
  const auto force = scaled(all.output.stress_Pa, area_ratio(set));
  row("stress, against the specimen's own mean", force, all.tool_stress, all.stress);
  if (set.density_kg_m3 > 0.0) {
    row("the same, with the specimen's own inertia",
        with_inertia(force, all.input, all.output, set), all.tool_stress, all.stress);
  }
  if (!set.keeps_volume) {
    const auto [nu, left] = widening(all, force);
    section.rows.push_back(
        {set.folder, fmt::format("the same, with a section that grows (ν = {:.3f}, fitted)", nu),
         left, "-"});
    const Impulses impulse = impulses(set, all);
    section.rows.push_back(
        {set.folder, "impulse, against the output bar's momentum afterwards", impulse.ours, "-"});
    section.rows.push_back(
        {set.folder, "impulse of the specimen's own mean on its first section, against the same",
         impulse.specimen, "-"});
  }
  section.rows.push_back({set.folder,
                          "first pulse's area under the input bar's gauge by every second sample",
                          area_by_half_the_samples(set, all), "-"});
  if (!set.keeps_volume) {
    section.rows.push_back({set.folder,
                            "input bar's motion from the area under its gauge alone, signed",
                            motion_from_area(set, all), "-"});
  }
  const auto strain = strain_between(all.input.velocity_m_per_s, all.output.velocity_m_per_s, set);
  row("strain, against the ends' velocities", strain, all.tool_strain, all.ends_strain);
  if (all.first_loaded < all.loaded) {
    row_until(all.first_loaded, "the same, first loading alone", strain, all.tool_strain,
              all.ends_strain);
  }
  row("strain, against the specimen's own mean", strain, all.tool_strain, all.strain);
}

}  // namespace

std::optional<Section> separated_waves() {
  const auto root = std::filesystem::path(KOLSKY_SHARED_DATA) / "fe/wave-separation";
  if (!std::filesystem::exists(root)) {
    return std::nullopt;
  }
  Section section{
      "Separated waves",
      "Two finite-element sets (`../shared/data/fe/wave-separation`), one gauge a bar, passes over "
      "each other: rms of what is off over the rms of what the solver had, until the specimen, "
      "past its peak, carries less than a tenth of it (impulses and areas: in per cent). Output "
      "bar: gauge and free end. Input bar: gauge and the output bar's force at its end "
      "(equilibrium). Beside it the columns of the tool that comes with the sets. "
      "Foam, stress: the force agrees with the output bar's momentum, the set's own mean on the "
      "first section does not, because that section grows. "
      "Foam, strain: the gauge's record is sampled too slowly for a bar of 50 mm. Every second "
      "sample gives the first pulse another area, and the area of all is another one than the "
      "end's motion needs, before any wave is separated; neither the band limit nor the theory of "
      "waves moves it, and that momentum stays in the input bar to the end. "
      "Copper, stress: the bars know the back face's force, the set the mean over a specimen that "
      "has mass (`--inertia axial`).",
      {"set", "quantity", "ours off [%]", "tool off [%]"},
      {}};
  for (const Set& set : {Set{"copper", 1.0, 0.016, 0.006, 0.008, 2.5e-6, 8940.0, true},
                         Set{"aluminum_foam", 1.6, 0.050, 0.015, 0.030, 10e-6, 0.0, false}}) {
    add(set, root / set.folder, section);
  }
  return section;
}

}  // namespace kolsky::accuracy
