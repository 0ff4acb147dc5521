#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/material.hpp"
#include "processing/base/measured.hpp"

namespace kolsky {

/// What the apparatus is: a bar to characterise, a split Hopkinson bar, a ball on an elastic bar.
enum class BenchKind { bar, shpb, impact };

/// Which strain the stored samples count as positive; or an incident pulse is.
enum class PositiveSense { compression, tension };

enum class Section { round, square };

/// What a wave meets at the end of a bar away from the specimen: nothing (it comes back inverted),
/// or a momentum trap or further bar that takes it.
enum class FarEnd { free, matched };

/// One bar. Square bars keep their side in `side_m`; force uses the equal area and dispersion the
/// radius b/sqrt(3), b half the side.
struct Bar {
  Measured length_m{};
  Measured diameter_m{};  ///< of a square bar: the diameter of equal area
  Measured density_kg_m3{};
  Measured poisson_ratio{};
  std::optional<Measured> youngs_modulus_Pa{};  ///< elastic bars only
  std::optional<Material>
      material{};  ///< of a viscoelastic output bar that is not of the bar model
  Section section = Section::round;
  std::optional<Measured> side_m{};  ///< square bars only
  FarEnd far_end = FarEnd::free;     ///< of the output bar; the input bar's is the impacted one

  [[nodiscard]] double area_m2() const;
  [[nodiscard]] double dispersion_radius_m() const;
  /// Whether the bench leaves what it is made of to the bar model.
  [[nodiscard]] bool takes_bar_model() const { return !youngs_modulus_Pa && !material; }
};

/// How a gauge's bridge is wired. `quarter`: one active arm. `half`: two axial gauges in opposite
/// arms. `half_poisson`: one axial and one transverse gauge in adjacent arms. `full_poisson`: two
/// of those.
enum class BridgeWiring { quarter, half, half_poisson, full_poisson };

/// What turns a gauge's volts into strain when the samples are the bridge amplifier's output.
struct Bridge {
  BridgeWiring wiring = BridgeWiring::quarter;
  Measured gauge_factor{};
  /// Growth of the gauge factor with tensile strain: dR/R = (factor + growth e) e. Semiconductors.
  Measured gauge_factor_per_strain{};
  Measured excitation_V{};
  Measured gain{1.0, 0.0};
  double gauge_resistance_ohm = 0.0;  ///< of one gauge; 0 where no lead or shunt needs it
  double lead_resistance_ohm = 0.0;   ///< of one wire in series with the active arm
  int lead_wires = 2;        ///< 2: both wires in the arm, 3: one of them in each of two arms
  int gauges_in_series = 1;  ///< 2: a diametrically opposite pair in one arm, cancels bending
  std::optional<double> shunt_resistance_ohm{};  ///< resistor put across the active arm
  std::optional<double> shunt_reading_V{};       ///< the step it gave; replaces `gain`
  /// Gain over what the shunt makes it, as well as its resistances and its step are known.
  Measured shunt_gain{1.0, 0.0};
};

/// One strain-gauge station, in the order of the capture's channels.
struct Gauge {
  std::string name{};
  std::string bar{};      ///< "input" or "output"
  Measured position_m{};  ///< input: from the impacted end; output: from the specimen's end
  Measured delay_s{};     ///< by which its channel records later than the bench's clock
  std::string unit{};     ///< "strain" or "V"
  std::optional<Measured> length_m{};
  std::optional<Bridge> bridge{};          ///< unit "V": either this ...
  std::optional<Measured> strain_per_V{};  ///< ... or a plain factor
  /// Of samples that are strain already: over what made them so, as well as gauge factor,
  /// excitation and gain filed beside them say that it is known.
  Measured strain_gain{1.0, 0.0};
  bool inverted = false;  ///< its readings have the other sign, as with exchanged leads
};

/// Relative standard deviation of what turns a gauge's reading into strain.
[[nodiscard]] double gain_sd(const Gauge& gauge);

/// A light beam across the ball's way, a channel of its own behind the gauges: bright, and dark or
/// at least another voltage while the ball is in it.
struct PhotoSensor {
  std::string name{};
  Measured distance_m{};  ///< of the beam from the struck end's face
};

/// What a channel of the digitiser records.
struct BenchChannel {
  std::string name;
  std::string unit;
};

/// Round specimen; a square one is filed by its diameter of equal area.
struct Specimen {
  Measured length_m{};
  Measured diameter_m{};
  std::optional<Measured> density_kg_m3{};
  std::optional<Measured> poisson_ratio{};

  [[nodiscard]] double area_m2() const;
};

struct Ball {
  Measured outer_diameter_m{};
  Measured core_diameter_m{};
  std::optional<Measured> mass_kg{};
  bool scale_density = false;
};

struct Striker {
  std::optional<Measured> length_m{};
  std::optional<Measured> diameter_m{};
  std::optional<Measured> density_kg_m3{};
  std::optional<Measured> speed_m_per_s{};
  /// Of an elastic striker that is not of the bar's material.
  std::optional<Measured> youngs_modulus_Pa{};

  /// By its density, to 2 %; where none is filed it is. One with a modulus of its own is not.
  [[nodiscard]] bool of_material(const Bar& bar) const;
};

/// The apparatus as the bench file states it.
struct Bench {
  BenchKind kind = BenchKind::shpb;
  Measured sampling_frequency_Hz{};
  PositiveSense positive = PositiveSense::compression;
  PositiveSense loading = PositiveSense::compression;  ///< what the incident pulse is
  Bar input{};
  std::optional<Bar> output{};  ///< shpb only
  std::vector<Gauge> gauges{};
  std::optional<Specimen> specimen{};        ///< shpb only
  std::optional<Ball> ball{};                ///< impact only
  std::vector<PhotoSensor> photo_sensors{};  ///< impact only: none, one or two
  std::optional<Striker> striker{};
  std::optional<Measured> temperature_K{};

  /// The bar a gauge sits on. @pre the gauge is of this bench
  [[nodiscard]] const Bar& bar_of(const Gauge& gauge) const;
  /// Distance from a gauge to the specimen's face. Input bar: length - position; output bar:
  /// position.
  [[nodiscard]] double distance_to_specimen_m(const Gauge& gauge) const;
  /// What a capture holds, in its order: the gauges, then the photo-sensors (in volts).
  [[nodiscard]] std::vector<BenchChannel> channels() const;
};

/// Whether the modulus of every bar is filed: none is viscoelastic.
[[nodiscard]] bool all_elastic(const Bench& bench);
/// Whether the bench leaves to the bar model what some bar is made of.
[[nodiscard]] bool takes_bar_model(const Bench& bench);

/// The input or the output bar. @throws InputError "bar" where the bench has none of that name
[[nodiscard]] const Bar& bar_named(const Bench& bench, const std::string& name);

/// Checks what a single number cannot show: ranges that catch unit mistakes (a 15 m bar, a density
/// of 1.18), gauges off their bar, parts that the kind needs or does not have, names used twice.
/// @throws InputError whose place is the key inside the bench file, as "bars.input.length_m"
void check(const Bench& bench);

}  // namespace kolsky
