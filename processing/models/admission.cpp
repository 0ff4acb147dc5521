#include "processing/models/admission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "processing/models/physics.hpp"
#include "processing/models/pulse_probe.hpp"
#include "processing/models/transfers.hpp"

namespace kolsky {

namespace {

using Values = std::vector<double>;
using Spectrum = std::vector<Complex>;

constexpr std::size_t kFrequencies = 60;
constexpr double kLowest_Hz = 50.0;
constexpr double kHighest_Hz = 200e3;
constexpr double kRounding = 1e-9;
constexpr double kBlind = 0.25;
constexpr double kSlowBar_m_per_s = 2200.0;
constexpr double kLargestStrain = 5e-3;
constexpr double kFlattest = 1e-2;  ///< slope of a map
constexpr std::size_t kMapPlaces = 201;

/// Everything an effect can change, along a path.
struct Said {
  Spectrum J;
  Spectrum specimen_J;
  Spectrum gamma;
  Spectrum reflection;
  Spectrum factor;  ///< of the gauge the effect is of
  Spectrum mapped;  ///< a ramp of strains as the record has it
  Spectrum slopes;
  Spectrum all;
};

class Examination {
 public:
  Examination(const Effect& effect, const Model& model, const Bench& bench)
      : effect_(effect), parameters_(effect.about().parameters), bench_(bench) {
    facts_.peak_strain = 2e-3;
    facts_.warmer_by_K = 3.0;
    for (int n = 0; n < 64; ++n) {
      facts_.time_s.push_back(1e-5 * n);
    }
    const Model paper = paper_model(bench.kind, false);
    for (const EffectUse& use : paper.effects) {
      add_base(model.find(use.id()) != nullptr ? *model.find(use.id()) : use);
    }
    for (const EffectUse& use : model.effects) {
      if (paper.find(use.id()) == nullptr) {
        add_base(use);
      }
    }
    gauge_ = effect.about().per_gauge ? std::min<std::size_t>(1, bench.gauges.size() - 1) : 0;
    // As far as a comparison goes: shorter waves than the bar is thick surface gauges do not see.
    const double blind_Hz =
        kBlind * kSlowBar_m_per_s / std::max(1e-4, bench.input.dispersion_radius_m());
    const double top = std::min({kHighest_Hz, bench.sampling_frequency_Hz / 2.0, blind_Hz});
    for (std::size_t k = 0; k < kFrequencies; ++k) {
      const double share = static_cast<double>(k) / (kFrequencies - 1);
      axis_.emplace_back(0.0,
                         2.0 * std::numbers::pi * kLowest_Hz * std::pow(top / kLowest_Hz, share));
    }
    collect_values();
  }

  std::optional<AdmissionProblem> first_problem() {
    const Said without = said(nullptr, axis_);
    if (auto problem = identity(without)) {
      return problem;
    }
    for (const Values& values : tried_) {
      const Said with = said(&values, axis_);
      if (auto problem = finite(with, values)) {
        return problem;
      }
      if (auto problem = passive(without, with, values)) {
        return problem;
      }
    }
    // What nobody seeks is there or not, and no fit moves it.
    if (auto problem = effect_.about().told_only ? std::nullopt : derivative(without)) {
      return problem;
    }
    const std::vector<Sizes> undamped = sizes();
    // What grows by less than 0.02 of its own frequency is hidden by the probes' damping.
    for (const double period_s : {1e-6, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5, 1e-4, 2e-4}) {
      if (auto problem = causal(period_s, undamped)) {
        return problem;
      }
    }
    return std::nullopt;
  }

 private:
  /// Of the library alone: other expressions may be at fault themselves.
  void add_base(const EffectUse& use) {
    const EffectAbout& about = use.effect->about();
    if (use.effect != &effect_ && find_effect(about.id) == use.effect && !about.per_gauge &&
        about.stage != Stage::record) {
      Values values;
      for (const ModelValue& value : use.values) {
        values.push_back(value.value);
      }
      base_.push_back({use.effect, 0, std::move(values)});
    }
  }

  [[nodiscard]] Values null_values() const {
    Values values;
    for (const EffectParameter& own : parameters_) {
      values.push_back(own.auxiliary() ? own.starts.front() : own.null_value);
    }
    return values;
  }

  /// Every start of the first auxiliary parameter, and each at its bounds.
  [[nodiscard]] std::vector<Values> with_auxiliaries(const Values& values) const {
    std::vector<Values> list{values};
    bool first = true;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const EffectParameter& own = parameters_[p];
      if (!own.auxiliary()) {
        continue;
      }
      Values places{own.lower, own.upper};
      if (first) {
        places.insert(places.end(), own.starts.begin(), own.starts.end());
      }
      first = false;
      for (const double place : places) {
        list.push_back(values);
        list.back()[p] = place;
      }
    }
    return list;
  }

  void collect_values() {
    std::vector<Values> strengths;
    std::vector<std::size_t> own;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const EffectParameter& parameter = parameters_[p];
      if (parameter.auxiliary()) {
        continue;
      }
      own.push_back(p);
      for (const double value :
           {parameter.null_value - parameter.typical, parameter.null_value + parameter.typical,
            parameter.lower, parameter.upper}) {
        if (value >= parameter.lower && value <= parameter.upper) {
          strengths.push_back(null_values());
          strengths.back()[p] = value;
        }
      }
    }
    constexpr std::size_t kMostCorners = 4;
    for (std::size_t corner = 0;
         own.size() > 1 && own.size() <= kMostCorners && corner < (std::size_t{1} << own.size());
         ++corner) {
      strengths.push_back(null_values());
      for (std::size_t i = 0; i < own.size(); ++i) {
        const EffectParameter& parameter = parameters_[own[i]];
        strengths.back()[own[i]] = (corner >> i) % 2 == 0 ? parameter.lower : parameter.upper;
      }
    }
    for (const Values& values : strengths) {
      for (Values& one : with_auxiliaries(values)) {
        tried_.push_back(std::move(one));
      }
    }
  }

  [[nodiscard]] Said said(const Values* values, const Spectrum& path) const {
    std::vector<AppliedEffect> effects = base_;
    if (values != nullptr) {
      const std::size_t copies = effect_.about().each_gauge ? bench_.gauges.size() : 1;
      for (std::size_t copy = 0; copy < copies; ++copy) {
        effects.push_back({&effect_, effect_.about().each_gauge ? copy : gauge_, *values});
      }
    }
    Scene scene(bench_, facts_, path);
    shape(effects, scene);
    Said out;
    const std::size_t places = path.size();
    const BarScene& bar = scene.bars.front();
    for (std::size_t k = 0; k < places; ++k) {
      out.J.push_back(bar.solid.compliance(path[k], k));
      out.reflection.push_back(scene.bars.back().reflection(k));
    }
    out.gamma = bar.gamma_per_m;
    out.factor = scene.gauges[gauge_].factor;
    const Transfers transfers = transfers_of(scene, 0);
    for (const auto& reading : transfers.reading) {
      out.all.insert(out.all.end(), reading.begin(), reading.end());
    }
    if (scene.specimen) {
      for (std::size_t k = 0; k < places; ++k) {
        out.specimen_J.push_back(scene.specimen->solid.compliance(path[k], k));
      }
      const SpecimenScene& own = *scene.specimen;
      for (const double number : {own.stiffening, own.friction, own.gap_m, own.parts ? 1.0 : 0.0,
                                  own.lateral_inertia_kg_per_m, own.punching}) {
        out.all.emplace_back(number);
      }
    }
    out.all.emplace_back(scene.record.bridge_b);
    for (std::vector<double> addition : scene.record.additions) {
      addition.resize(facts_.time_s.size(), 0.0);
      out.all.insert(out.all.end(), addition.begin(), addition.end());
    }
    map_ramp(scene, out);
    return out;
  }

  void map_ramp(const Scene& scene, Said& out) const {
    constexpr double kStep = 1e-12;
    Spectrum ramp;
    for (std::size_t i = 0; i < kMapPlaces; ++i) {
      ramp.emplace_back(kLargestStrain * (2.0 * static_cast<double>(i) / (kMapPlaces - 1) - 1.0),
                        kStep);
    }
    if (gauge_ < scene.record.maps.size()) {
      for (const RecordMap& map : scene.record.maps[gauge_]) {
        Spectrum next(ramp.size());
        map(ramp, next);
        ramp = std::move(next);
      }
    }
    for (const Complex value : ramp) {
      out.mapped.emplace_back(value.real());
      out.slopes.emplace_back(value.imag() / kStep);
    }
    // In units of strains of ordinary size, beside readings of order one.
    for (const Complex value : out.mapped) {
      out.all.push_back(value / kLargestStrain);
    }
  }

  [[nodiscard]] std::string at(const Values& values) const {
    std::string text;
    for (std::size_t p = 0; p < values.size(); ++p) {
      text += fmt::format("{}{} = {:.4g}", p == 0 ? "" : ", ", parameters_[p].name, values[p]);
    }
    return text;
  }

  static double difference(const Said& a, const Said& b) {
    double largest = 0.0;
    for (std::size_t k = 0; k < a.all.size(); ++k) {
      const double own = std::abs(a.all[k] - b.all[k]) / (1.0 + std::abs(b.all[k]));
      largest = own > largest || std::isnan(own) ? own : largest;
    }
    return largest;
  }

  [[nodiscard]] std::optional<AdmissionProblem> identity(const Said& without) const {
    for (const Values& values : with_auxiliaries(null_values())) {
      const double off = difference(said(&values, axis_), without);
      if (!(off < kRounding)) {
        return AdmissionProblem{
            "identity", "changes something at its null values (" + at(values) + ")",
            "write it so that it is not there at null, or mend the null values"};
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<AdmissionProblem> finite(const Said& with,
                                                       const Values& values) const {
    for (const Spectrum* spectrum : {&with.J, &with.specimen_J, &with.gamma, &with.reflection,
                                     &with.factor, &with.mapped, &with.slopes, &with.all}) {
      for (const Complex value : *spectrum) {
        if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) {
          return AdmissionProblem{"finite", "is not finite at " + at(values),
                                  "narrow the bounds of its parameters"};
        }
      }
    }
    return std::nullopt;
  }

  /// Which way off null energy is gained, as a mend.
  [[nodiscard]] std::string narrower(const Values& values) const {
    for (std::size_t p = 0; p < values.size(); ++p) {
      const EffectParameter& own = parameters_[p];
      if (!own.auxiliary() && values[p] != own.null_value) {
        const bool below = values[p] < own.null_value;
        return fmt::format(
            "bring the {} bound of {} nearer to its null {:g}, or turn the sign of "
            "its term",
            below ? "lower" : "upper", own.name, own.null_value);
      }
    }
    return "narrow the bounds of its parameters";
  }

  [[nodiscard]] AdmissionProblem gain(const std::string& what, std::size_t k,
                                      const Values& values) const {
    return {"passivity",
            fmt::format("{} at {}, {:.3g} Hz", what, at(values),
                        axis_[k].imag() / (2.0 * std::numbers::pi)),
            narrower(values)};
  }

  [[nodiscard]] std::optional<AdmissionProblem> passive(const Said& without, const Said& with,
                                                        const Values& values) const {
    const auto worse = [](double loss, double before, double scale) {
      return loss < std::min(0.0, before) - kRounding * scale;
    };
    const auto solid = [&](const Spectrum& before, const Spectrum& after,
                           std::size_t k) -> const char* {
      if (worse(-after[k].imag(), -before[k].imag(), std::abs(after[k]))) {
        return "gives energy back (Im J > 0)";
      }
      return worse(after[k].real(), before[k].real(), 0.0) ? "makes J negative" : nullptr;
    };
    for (std::size_t k = 0; k < axis_.size(); ++k) {
      if (const char* what = solid(without.J, with.J, k)) {
        return gain(what, k, values);
      }
      if (!with.specimen_J.empty()) {
        if (const char* what = solid(without.specimen_J, with.specimen_J, k)) {
          return gain(what, k, values);
        }
      }
      if (worse(with.gamma[k].real(), without.gamma[k].real(), std::abs(with.gamma[k]))) {
        return gain("makes waves grow (Re gamma < 0)", k, values);
      }
      const double returned = std::abs(with.reflection[k]);
      if (returned > std::max(1.0, std::abs(without.reflection[k])) + kRounding) {
        return gain(fmt::format("returns {:.3g} of a wave", returned), k, values);
      }
    }
    for (const Complex slope : with.slopes) {
      if (slope.real() < kFlattest) {
        return AdmissionProblem{"inverse",
                                "does not rise with strain all over 5000 microstrain at " +
                                    at(values) + ", so that no reading tells the strain",
                                narrower(values)};
      }
    }
    return std::nullopt;
  }

  /// Two steps off null must change everything in proportion.
  [[nodiscard]] std::optional<AdmissionProblem> derivative(const Said& without) const {
    constexpr double kSmaller = 0.1;
    constexpr double kProportion = 0.3;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      const EffectParameter& own = parameters_[p];
      if (own.auxiliary()) {
        continue;
      }
      const double up = own.null_value + own.difference * own.typical <= own.upper ? 1.0 : -1.0;
      const auto change = [&](double share) {
        Values values = null_values();
        values[p] += up * share * own.difference * own.typical;
        return difference(said(&values, axis_), without);
      };
      // A step of a whole typical size where the step of differences drowns in rounding.
      const double size =
          change(1.0) > 1e3 * kRounding * own.difference ? 1.0 : 1.0 / own.difference;
      const double large = change(size);
      const double small = change(kSmaller * size) / kSmaller;
      if (large == 0.0) {
        return AdmissionProblem{"derivative", own.name + " changes nothing",
                                "check the formula, or leave the parameter out"};
      }
      if (!(std::abs(large - small) < kProportion * large)) {
        return AdmissionProblem{
            "derivative", "has no finite derivative by " + own.name + " at null, or none but zero",
            "let its term grow in proportion to " + own.name + " at first"};
      }
    }
    return std::nullopt;
  }

  /// What the effect says at one stage along a probe's path, with it and without.
  struct Response {
    const Spectrum& with;
    const Spectrum& without;
    double size;          ///< largest along the axis of real frequencies
    bool waves = false;   ///< a wavenumber: only what it changes of the bar's own is a response
    double lead_s = 0.0;  ///< by which it may answer early
  };

  /// Largest values along the axis of real frequencies, for each of the values tried.
  struct Sizes {
    double J = 0.0;
    double specimen_J = 0.0;
    double reflection = 0.0;
    double factor = 0.0;
  };
  [[nodiscard]] std::vector<Sizes> sizes() const {
    std::vector<Sizes> list;
    for (const Values& values : tried_) {
      const Said undamped = said(&values, axis_);
      list.push_back({largest(undamped.J), largest(undamped.specimen_J),
                      largest(undamped.reflection), largest(undamped.factor)});
    }
    return list;
  }

  [[nodiscard]] std::optional<AdmissionProblem> causal(double period_s,
                                                       const std::vector<Sizes>& sizes) const {
    PulseProbe probe(period_s);
    const Said without = said(nullptr, probe.path());
    for (std::size_t n = 0; n < tried_.size(); ++n) {
      const Values& values = tried_[n];
      const Said with = said(&values, probe.path());
      const std::array<Response, 5> responses{
          {{with.J, without.J, sizes[n].J},
           {with.specimen_J, without.specimen_J, sizes[n].specimen_J},
           {with.gamma, without.gamma, 1.0, true},
           {with.reflection, without.reflection, sizes[n].reflection},
           {with.factor, without.factor, sizes[n].factor, false, kSensorLead_s}}};
      for (const Response& response : responses) {
        if (auto problem = early(probe, response, values)) {
          return problem;
        }
      }
    }
    return std::nullopt;
  }

  [[nodiscard]] static double largest(const Spectrum& spectrum) {
    double most = 0.0;
    for (const Complex value : spectrum) {
      most = std::max(most, std::abs(value));
    }
    return most;
  }

  [[nodiscard]] std::optional<AdmissionProblem> early(PulseProbe& probe, const Response& response,
                                                      const Values& values) const {
    constexpr double kEarly = 2e-3;
    constexpr double kWrapped = 1e-6;  ///< of the response's size
    Spectrum answer(response.with.size());
    for (std::size_t k = 0; k < answer.size(); ++k) {
      answer[k] = probe.pulse()[k] *
                  (response.waves ? response.with[k] / response.without[k] : response.with[k]);
      if (!std::isfinite(std::abs(answer[k]))) {
        const Complex s = probe.path()[k];
        return AdmissionProblem{"finite",
                                fmt::format("is not finite at {}, s = {:.3g} + {:.3g}i 1/s",
                                            at(values), s.real(), s.imag()),
                                "narrow the bounds of its parameters"};
      }
    }
    if (response.with == response.without) {
      return std::nullopt;
    }
    const PulseProbe::Answer found = probe.answer(answer, response.lead_s);
    if (found.before_pulse <= kEarly * found.anywhere ||
        found.before_pulse <= kWrapped * response.size) {
      return std::nullopt;
    }
    return AdmissionProblem{"causality",
                            fmt::format("answers before it is asked at {}: {:.2g} of the answer to "
                                        "a pulse comes before the pulse",
                                        at(values), found.before_pulse / found.anywhere),
                            "look for poles or advances (exp(+s tau), 1/(1 - s tau)), or narrow "
                            "the bounds"};
  }

  const Effect& effect_;
  const std::vector<EffectParameter>& parameters_;
  const Bench& bench_;
  std::size_t gauge_ = 0;
  ShotFacts facts_;
  std::vector<AppliedEffect> base_;
  Spectrum axis_;
  std::vector<Values> tried_;
};

}  // namespace

Bench admission_bench(BenchKind kind) {
  Bench bench;
  bench.kind = kind;
  bench.sampling_frequency_Hz = {1e6, 0.0};
  bench.input.length_m = {2.0, 0.0};
  bench.input.diameter_m = {0.02, 0.0};
  bench.input.density_kg_m3 = {1180.0, 0.0};
  bench.input.poisson_ratio = {0.36, 0.0};
  for (const auto& [name, position_m] :
       {std::pair{"g1", 0.2}, std::pair{"g2", 0.6}, std::pair{"g3", 1.1}}) {
    Gauge gauge;
    gauge.name = name;
    gauge.bar = "input";
    gauge.position_m = {position_m, 0.0};
    gauge.unit = "strain";
    bench.gauges.push_back(std::move(gauge));
  }
  if (kind == BenchKind::shpb) {
    bench.output = bench.input;
    bench.gauges.back().bar = "output";
    bench.specimen =
        Specimen{{0.004, 0.0}, {0.012, 0.0}, Measured{1140.0, 0.0}, Measured{0.376, 0.0}};
  }
  return bench;
}

std::optional<AdmissionProblem> admission_problem(const Effect& effect, const Model& model,
                                                  const Bench& bench) {
  return Examination(effect, model, bench).first_problem();
}

}  // namespace kolsky
