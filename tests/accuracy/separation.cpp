#include "processing/separation/separation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <sstream>

#include "tests/accuracy/sampled_step.hpp"
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

/// What is off, over the truth, in per cent.
struct Off {
  double of_rms = 0.0;   ///< rms over rms
  double of_peak = 0.0;  ///< rms over the largest
  double median = 0.0;   ///< of what is off over the truth, where that is a tenth of its largest
};

Off off(const std::vector<double>& found, const std::vector<double>& truth) {
  double difference = 0.0;
  double size = 0.0;
  double largest = 0.0;
  const std::size_t count = std::min(found.size(), truth.size());
  for (std::size_t n = 0; n < count; ++n) {
    difference += std::pow(found[n] - truth[n], 2);
    size += std::pow(truth[n], 2);
    largest = std::max(largest, std::abs(truth[n]));
  }
  std::vector<double> shares;
  for (std::size_t n = 0; n < count; ++n) {
    if (std::abs(truth[n]) > 0.1 * largest) {
      shares.push_back(std::abs(found[n] - truth[n]) / std::abs(truth[n]));
    }
  }
  const auto middle = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2);
  std::nth_element(shares.begin(), middle, shares.end());
  return {100.0 * std::sqrt(difference / size),
          100.0 * std::sqrt(difference / static_cast<double>(count)) / largest, 100.0 * *middle};
}

struct Set {
  const char* folder;
  double length_m, diameter_m;
  double specimen_length_m, specimen_diameter_m;
  double step_s;
  double density_kg_m3;  ///< the specimen's, of a handbook; 0 where it cannot be known
  bool keeps_volume;     ///< the specimen; else it keeps its section
};

/// What both bars' records give, and what the finite elements and the tool had. Samples are taken
/// as even, as an import takes them: the filed times are so to 1.3 % of a step, and lines drawn
/// between samples of a front that lasts three would cost more.
struct Histories {
  SeparatedWaves input, output;
  std::vector<double> input_gauge, output_gauge, input_velocity, output_velocity;
  std::vector<double> stress, strain, ends_strain;
  std::vector<double> tool_input_velocity, tool_output_velocity, tool_stress, tool_strain;
  std::size_t loaded =
      0;  ///< samples until the specimen, past its peak, carries less than a tenth of it
  std::size_t first_loaded = 0;  ///< the same of the first loading
  std::size_t peak = 0;          ///< samples until it carries most
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
  const Bar bar = bar_of(set);
  const ElasticSolid solid(kSteelModulus);
  // What the reduction allows itself of a noiseless record.
  const double band_Hz = 0.2 / set.step_s;
  Histories all;
  all.input_gauge = records.at("gauge1_incident_bar_strain");
  all.output_gauge = records.at("gauge2_transmission_bar_strain");
  all.output = WaveSeparation(bar, solid, WaveTheory::exact, {{kToSpecimen, all.output_gauge, 0.0}},
                              {.start = false, .end = true}, set.step_s, band_Hz)
                   .at(0.0);
  // Equilibrium: the specimen presses on both bars alike, and they are of one diameter.
  all.input =
      WaveSeparation(bar, solid, WaveTheory::exact,
                     {{set.length_m - kToSpecimen, all.input_gauge, 0.0},
                      {set.length_m, all.output.stress_Pa, 0.0, SeparationRecord::mean_stress_Pa}},
                     {}, set.step_s, band_Hz)
          .at(set.length_m);
  all.input_velocity = scaled(records.at("incident_end_mean_v3_mm_per_s"), 1e-3);
  all.output_velocity = scaled(records.at("transmitted_end_mean_v3_mm_per_s"), 1e-3);
  all.ends_strain = strain_between(all.input_velocity, all.output_velocity, set);
  all.stress = scaled(records.at("specimen_mean_compressive_s33_MPa"), 1e6);
  const auto log_strain = records.at("specimen_mean_compressive_le33");
  for (std::size_t n = 0; n < all.stress.size(); ++n) {
    all.strain.push_back(1.0 - std::exp(-log_strain[n]));
    all.stress[n] *= set.keeps_volume ? std::exp(log_strain[n]) : 1.0;
  }
  const auto peak = std::max_element(all.stress.begin(), all.stress.end());
  const auto released =
      std::find_if(peak, all.stress.end(), [&](double stress) { return stress < 0.1 * *peak; });
  all.loaded = static_cast<std::size_t>(released - all.stress.begin());
  all.peak = static_cast<std::size_t>(peak - all.stress.begin());
  all.first_loaded = first_release(all.stress);
  const double c = std::sqrt(kSteelModulus / kSteelDensity);
  const auto tool_velocity = [&](const std::string& end) {
    auto right = waves.at(end + "_right_going");
    const auto left = waves.at(end + "_left_going");
    for (std::size_t n = 0; n < right.size(); ++n) {
      right[n] = c * (right[n] - left[n]);
    }
    return right;
  };
  all.tool_input_velocity = tool_velocity("incident_end");
  all.tool_output_velocity = tool_velocity("transmitted_end");
  all.tool_stress = scaled(tool.at("engineering_stress_MPa"), 1e6);
  all.tool_strain = tool.at("engineering_strain");
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

/// Late in the loading both bars carry the force alike, but for waves that run to and fro: averaged
/// over the time of a round trip they are gone. What one gauge then reads over what the other does
/// [%], by least squares.
std::string gauge_against_gauge(const Set& set, const Histories& all) {
  const auto trip = static_cast<std::size_t>(
      std::lround(2.0 * set.length_m / std::sqrt(kSteelModulus / kSteelDensity) / set.step_s));
  double both = 0.0;
  double output = 0.0;
  for (std::size_t n = all.loaded / 2; n + trip < all.loaded; ++n) {
    const auto mean = [&](const std::vector<double>& values) {
      const auto from = values.begin() + static_cast<std::ptrdiff_t>(n);
      return std::accumulate(from, from + static_cast<std::ptrdiff_t>(trip), 0.0);
    };
    both += mean(all.input_gauge) * mean(all.output_gauge);
    output += std::pow(mean(all.output_gauge), 2);
  }
  return fmt::format("{:+.2f}", 100.0 * (both / output - 1.0));
}

/// Its section grows as exp(2 nu e), e the largest logarithmic strain so far: the nu at which the
/// specimen's own mean is nearest to the force.
std::pair<double, Off> widening(const Histories& all, const std::vector<double>& force) {
  std::pair<double, Off> best{0.0, {1e300, 1e300, 1e300}};
  for (double nu = 0.0; nu < 0.05; nu += 0.001) {
    double largest = 0.0;
    std::vector<double> stress;
    for (std::size_t n = 0; n < all.loaded; ++n) {
      largest = std::max(largest, -std::log(1.0 - all.strain[n]));
      stress.push_back(all.stress[n] * std::exp(2.0 * nu * largest));
    }
    const Off left = off(shortened(force, all.loaded), stress);
    if (left.of_rms < best.second.of_rms) {
      best = {nu, left};
    }
  }
  return best;
}

void add(const Set& set, const std::filesystem::path& folder, Section& section) {
  const Histories all = histories(set, folder);
  const auto in_words = [](double value) { return fmt::format("{:.2f}", value); };
  const auto row_until = [&](std::size_t end, const std::string& quantity,
                             const std::vector<double>& ours, const std::vector<double>& tool,
                             const std::vector<double>& truth) {
    const Off own = off(shortened(ours, end), shortened(truth, end));
    const Off other = off(shortened(tool, end), shortened(truth, end));
    section.rows.push_back({set.folder, quantity, in_words(own.of_rms), in_words(other.of_rms),
                            in_words(own.of_peak), in_words(other.of_peak), in_words(own.median),
                            in_words(other.median)});
  };
  const auto one = [&](const std::string& quantity, const std::string& value) {
    section.rows.push_back({set.folder, quantity, value, "-", "-", "-", "-", "-"});
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
  row_until(all.peak, "the same, while the load rises", force, all.tool_stress, all.stress);
  if (set.density_kg_m3 > 0.0) {
    row("the same, with the specimen's own inertia",
        with_inertia(force, all.input, all.output, set), all.tool_stress, all.stress);
  }
  if (!set.keeps_volume) {
    const auto [nu, left] = widening(all, force);
    section.rows.push_back(
        {set.folder, fmt::format("the same, with a section that grows (ν = {:.3f}, fitted)", nu),
         in_words(left.of_rms), "-", in_words(left.of_peak), "-", in_words(left.median), "-"});
    const Impulses impulse = impulses(set, all);
    one("impulse, against the output bar's momentum afterwards", impulse.ours);
    one("impulse of the specimen's own mean on its first section, against the same",
        impulse.specimen);
  }
  one("first pulse's area under the input bar's gauge by every second sample",
      area_by_half_the_samples(set, all));
  if (!set.keeps_volume) {
    one("input bar's motion from the area under its gauge alone, signed",
        motion_from_area(set, all));
    one("input bar's gauge against the output bar's while both carry the same force, signed",
        gauge_against_gauge(set, all));
    one("a step's area under that gauge by its samples, rms over where they fall",
        in_words(100.0 * area_by_sampling(bar_of(set), kSteelModulus, kToSpecimen, set.step_s, 0)));
    one("the same, of a front that rises within a sample",
        in_words(100.0 * area_by_sampling(bar_of(set), kSteelModulus, kToSpecimen, set.step_s,
                                          set.step_s)));
  }
  const auto strain = strain_between(all.input.velocity_m_per_s, all.output.velocity_m_per_s, set);
  row("strain, against the ends' velocities", strain, all.tool_strain, all.ends_strain);
  row_until(all.peak, "the same, while the load rises", strain, all.tool_strain, all.ends_strain);
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
      "each other: rms of what is off over the rms and over the largest of what the solver had, "
      "and "
      "the median of what is off over what it had where that is more than a tenth of its largest, "
      "until the specimen, past its peak, carries less than a tenth of it, or its peak (\"while "
      "the "
      "load rises\"; impulses and areas: in per cent). Output "
      "bar: gauge and free end. Input bar: gauge and the output bar's force at its end "
      "(equilibrium). Beside it the columns of the tool that comes with the sets. "
      "Foam, stress: the force agrees with the output bar's momentum, the set's own mean on the "
      "first section does not, because that section grows. "
      "Foam, strain: the area under the input bar's gauge by itself, before any wave is separated, "
      "is another one than the end's motion needs, though the gauge agrees with the output bar's "
      "once both carry the same force; the area that samples 10 us apart give a front in a bar of "
      "50 mm is no better known, and the striker is as long as the bar, so that no later front "
      "tells it again. Neither the band limit nor the theory of waves moves it. "
      "Copper, stress: the bars know the back face's force, the set the mean over a specimen that "
      "has mass (`--inertia axial`).",
      {"set", "quantity", "ours off [%]", "tool off [%]", "ours, of the peak [%]",
       "tool, of the peak [%]", "ours, median [%]", "tool, median [%]"},
      {}};
  for (const Set& set : {Set{"copper", 1.0, 0.016, 0.006, 0.008, 2.5e-6, 8940.0, true},
                         Set{"aluminum_foam", 1.6, 0.050, 0.015, 0.030, 10e-6, 0.0, false}}) {
    add(set, root / set.folder, section);
  }
  return section;
}

}  // namespace kolsky::accuracy
