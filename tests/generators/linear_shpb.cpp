#include "tests/generators/linear_shpb.hpp"

#include <cmath>
#include <numbers>

#include "drivers/simulated/rod.hpp"

namespace kolsky::testing {

namespace {

double circle_m2(double diameter_m) {
  return std::numbers::pi * diameter_m * diameter_m / 4.0;
}

Bar bar_of(const RodMaterial& material, double length_m, double diameter_m) {
  Bar bar;
  bar.length_m = {length_m};
  bar.diameter_m = {diameter_m};
  bar.density_kg_m3 = {material.density_kg_m3};
  bar.poisson_ratio = {material.elastic() ? 0.3 : 0.36};
  if (material.elastic()) {
    bar.youngs_modulus_Pa = Measured{material.E1_Pa};
  }
  return bar;
}

Gauge gauge_of(const char* name, const char* bar, double position_m) {
  Gauge gauge;
  gauge.name = name;
  gauge.bar = bar;
  gauge.position_m = {position_m};
  gauge.unit = "strain";
  return gauge;
}

/// What has no mass between two faces.
class MasslessSpecimen {
 public:
  MasslessSpecimen(const KelvinChain& chain, double length_m, double area_m2, double step_s)
      : solid_(chain, step_s),
        length_m_(length_m),
        area_m2_(area_m2),
        strains_(chain.elements.size(), 0.0) {}

  [[nodiscard]] double force_N() const { return area_m2_ * stress_Pa_; }

  void advance(double closing_m_per_s) {
    strain_ += closing_m_per_s / length_m_ * solid_.step_s();
    const auto& elements = solid_.elements();
    double inner = 0.0;  // strain of the elements if the stress at the step's end were none
    double per_stress = 1.0 / solid_.glassy_Pa();
    for (std::size_t i = 0; i < elements.size(); ++i) {
      strains_[i] = elements[i].keep * strains_[i] + elements[i].from_old * stress_Pa_;
      inner += strains_[i];
      per_stress += elements[i].from_new;
    }
    stress_Pa_ = (strain_ - inner) / per_stress;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      strains_[i] += elements[i].from_new * stress_Pa_;
    }
  }

 private:
  KelvinStep solid_;
  double length_m_;
  double area_m2_;
  std::vector<double> strains_;
  double strain_ = 0.0;
  double stress_Pa_ = 0.0;
};

KelvinChain chain_of(const RodMaterial& m) {
  return m.elastic() ? elastic(m.E1_Pa) : three_element(m.E1_Pa, m.E2_Pa, m.eta2_Pa_s);
}

/// Faces that never part: the impulse that keeps both velocities alike.
void join(Rod& before, Rod& after, double step_s) {
  const double a = before.end_mass_kg();
  const double b = after.end_mass_kg();
  const double force_N =
      (before.back_velocity() - after.front_velocity()) * a * b / (a + b) / step_s;
  before.push_back(force_N);
  after.push_front(force_N);
}

}  // namespace

Bench LinearShpb::bench() const {
  Bench bench;
  bench.kind = BenchKind::shpb;
  bench.sampling_frequency_Hz = {sampling_frequency_Hz, 0.0};
  bench.input = bar_of(input, input_length_m, bar_diameter_m);
  bench.output = bar_of(output, output_length_m, output_diameter_m);
  bench.gauges = {gauge_of("g1", "input", gauge_in_m), gauge_of("g2", "output", gauge_out_m)};
  bench.specimen = Specimen{.length_m = {specimen_length_m},
                            .diameter_m = {specimen_diameter_m},
                            .density_kg_m3 = Measured{specimen.density_kg_m3},
                            .poisson_ratio = Measured{0.376}};
  return bench;
}

std::vector<std::vector<double>> LinearShpb::solve() const {
  const double step_s = 1.0 / (sampling_frequency_Hz * steps_per_sample);
  const double area_m2 = circle_m2(bar_diameter_m);
  const double specimen_area_m2 = circle_m2(specimen_diameter_m);
  Rod in({input_length_m, area_m2, input}, step_s);
  Rod out({output_length_m, circle_m2(output_diameter_m), output}, step_s);
  MasslessSpecimen spring(chain.value_or(chain_of(specimen)), specimen_length_m, specimen_area_m2,
                          step_s);
  Rod rod({specimen_length_m, specimen_area_m2, specimen}, step_s);
  const ImpactPulse pulse{
      .peak_force_N = input.E1_Pa * area_m2 * peak_strain, .duration_s = pulse_s, .ramp_s = ramp_s};
  const auto quiet = static_cast<std::size_t>(std::llround(pre_s * sampling_frequency_Hz));
  const auto samples = static_cast<std::size_t>(std::llround(record_s * sampling_frequency_Hz));
  std::vector<std::vector<double>> records(2, std::vector<double>(samples, 0.0));
  const auto per_sample = static_cast<std::size_t>(steps_per_sample);
  for (std::size_t step = 0; step < (samples - quiet) * per_sample; ++step) {
    if (step % per_sample == 0) {
      const std::size_t n = quiet + step / per_sample;
      records[0][n] = gain_in * in.strain_at(gauge_in_m);
      records[1][n] = gain_out * out.strain_at(gauge_out_m);
    }
    in.advance_velocities();
    out.advance_velocities();
    in.push_front(pulse.force_N(static_cast<double>(step) * step_s));
    if (massless) {
      in.push_back(spring.force_N());
      out.push_front(spring.force_N());
      spring.advance(in.back_velocity() - out.front_velocity());
    } else {
      rod.advance_velocities();
      join(in, rod, step_s);
      join(rod, out, step_s);
      rod.advance_strains();
    }
    in.advance_strains();
    out.advance_strains();
  }
  return records;
}

}  // namespace kolsky::testing
