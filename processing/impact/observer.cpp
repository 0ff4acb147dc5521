#include "processing/impact/observer.hpp"

#include <algorithm>
#include <cmath>

#include "processing/impact/quadrilateral.hpp"

namespace kolsky::impact {
namespace {

constexpr double kContactShare = 0.01;  // of the peak: contact_time_s counts above it
constexpr double kSmallStrain = 0.1;    // to which the linear laws were identified
constexpr double kPatchShare = 0.07;    // a probe's patch, of the ball's radius

Field field_of(const Body& ball, double time_s) {
  Field field;
  field.time_s = time_s;
  for (const Region& region : ball.mesh().regions) {
    const Block& block = ball.mesh().blocks[region.block];
    for (std::size_t row = region.first_row; row < region.first_row + region.rows; ++row) {
      for (std::size_t column = 0; column < block.columns; ++column) {
        FieldElement element;
        const auto nodes = corners(block, column, row);
        constexpr std::array<std::size_t, 4> kRound = {0, 1, 3, 2};
        for (std::size_t k = 0; k < 4; ++k) {
          element.r_m[k] = ball.r_m(nodes[kRound[k]]);
          element.z_m[k] = ball.z_m(nodes[kRound[k]]);
        }
        element.axial_stress_Pa = -ball.axial_stress_Pa({region.block, column, row});
        element.layer = region.solid;
        field.elements.push_back(element);
      }
    }
  }
  return field;
}

}  // namespace

Observer::Observer(const ImpactModel& model, const Body& ball, double longest_s)
    : interval_s_(model.output_interval_s),
      positions_m_(model.gauge_positions_m),
      field_times_s_(model.field_times_s),
      field_at_turn_(model.field_at_turn) {
  small_strain_.assign(model.layers.size(), kSmallStrain);
  strained_share_.assign(model.layers.size(), 0.0);
  for (const Layer& layer : model.layers) {
    falling_strain_.push_back(layer.solid.falls_beyond_strain());
  }
  falling_share_.assign(model.layers.size(), 0.0);
  const auto room = static_cast<std::size_t>(longest_s / interval_s_) + 3;
  impulse_.assign(room, 0.0);
  radius_m_.reserve(room);
  for (const Probe& probe : model.probes) {
    patches_.push_back(patch_round(ball, probe));
    probe_strain_.emplace_back().reserve(room);
  }
  for (std::size_t i = 0; i < positions_m_.size(); ++i) {
    gauge_strain_.emplace_back().reserve(room);
  }
  std::sort(field_times_s_.begin(), field_times_s_.end(), std::greater<>());
}

// The elements whose middle is near the point, by volume; at least the nearest.
Observer::Patch Observer::patch_round(const Body& ball, const Probe& probe) {
  const Mesh& mesh = ball.mesh();
  const double radius_m = ball.z_m(mesh.surface.back()) / 2.0;
  const double z_m = radius_m - probe.axial_m;
  Patch patch;
  ElementIndex nearest;
  double nearest_m = 2.0 * radius_m;
  double total = 0.0;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    for (std::size_t row = 0; row < mesh.blocks[b].rows; ++row) {
      for (std::size_t column = 0; column < mesh.blocks[b].columns; ++column) {
        double R_m = 0.0;
        double Z_m = 0.0;
        for (const std::size_t node : corners(mesh.blocks[b], column, row)) {
          R_m += 0.25 * mesh.R_m[node];
          Z_m += 0.25 * mesh.Z_m[node];
        }
        const double distance_m = std::hypot(R_m - probe.radial_m, Z_m - z_m);
        if (distance_m < nearest_m) {
          nearest_m = distance_m;
          nearest = {b, column, row};
        }
        if (distance_m < kPatchShare * radius_m) {
          patch.elements.push_back({b, column, row});
          patch.weights.push_back(R_m);
          total += R_m;
        }
      }
    }
  }
  if (patch.elements.empty()) {
    return {{nearest}, {1.0}};
  }
  for (double& weight : patch.weights) {
    weight /= total;
  }
  return patch;
}

// Engineering strain of the surface between the middles of the elements either side.
double Observer::bar_strain(const Body& bar, double position_m) {
  const Block& block = bar.mesh().blocks.front();
  const double length_m = -bar.mesh().Z_m[block.node(0, 0)];
  const double size_m = length_m / static_cast<double>(block.rows);
  const double place = (length_m - position_m) / size_m - 0.5;  // in elements' middles
  const double clamped = std::clamp(place, 0.0, static_cast<double>(block.rows) - 1.0);
  const std::size_t row = std::min(static_cast<std::size_t>(clamped), block.rows - 2);
  const double share = clamped - static_cast<double>(row);
  const auto strain = [&](std::size_t j) {
    return -(bar.axial_displacement(block.node(block.columns, j + 1)) -
             bar.axial_displacement(block.node(block.columns, j))) /
           size_m;
  };
  return (1.0 - share) * strain(row) + share * strain(row + 1);
}

void Observer::spread(double from_s, double to_s, double force_N) {
  // Sample k holds from (k - 1/2) to (k + 1/2) intervals.
  double at = std::max(from_s, 0.0) / interval_s_ + 0.5;
  const double end = to_s / interval_s_ + 0.5;
  while (at < end) {
    const auto k = static_cast<std::size_t>(at);
    const double stop = std::min(end, static_cast<double>(k + 1));
    if (k < impulse_.size()) {
      impulse_[k] += force_N * (stop - at) * interval_s_;
    }
    at = stop > at ? stop : end;
  }
}

void Observer::look(const Body& ball, const Body* bar, double radius_m) {
  radius_m_.push_back(radius_m);
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    double strain = 0.0;
    for (std::size_t k = 0; k < patches_[i].elements.size(); ++k) {
      strain -= patches_[i].weights[k] * ball.axial_log_stretch(patches_[i].elements[k]);
    }
    probe_strain_[i].push_back(strain);
  }
  for (std::size_t i = 0; i < positions_m_.size(); ++i) {
    gauge_strain_[i].push_back(bar_strain(*bar, positions_m_[i]));
  }
}

void Observer::keep_fields(double time_s, const Body& ball) {
  while (!field_times_s_.empty() && time_s >= field_times_s_.back()) {
    fields_.push_back(field_of(ball, time_s));
    field_times_s_.pop_back();
  }
}

// The largest deformation is where the centre of mass turns round.
void Observer::watch_turn(double time_s, const Body& ball) {
  if (turned_ || ball.axial_momentum() < 0.0) {
    return;
  }
  turned_ = true;
  ball.find_strained_share(small_strain_, strained_share_);
  ball.find_strained_share(falling_strain_, falling_share_);
  if (field_at_turn_) {
    fields_.push_back(field_of(ball, time_s));
  }
}

void Observer::add(double time_s, double width_s, const ContactSums& touch, const Body& ball,
                   const Body* bar) {
  spread(time_s - 0.5 * width_s, time_s + 0.5 * width_s, touch.force_N);
  largest_radius_m_ = std::max(largest_radius_m_, touch.radius_m);
  last_s_ = time_s;
  while (static_cast<double>(radius_m_.size()) * interval_s_ <= time_s &&
         radius_m_.size() < impulse_.size()) {
    look(ball, bar, touch.radius_m);
    watch_turn(time_s, ball);
  }
  keep_fields(time_s, ball);
}

ImpactHistory Observer::history() {
  ImpactHistory history;
  const std::size_t samples = radius_m_.size();
  double above_from_s = -1.0;
  for (std::size_t k = 0; k < samples; ++k) {
    history.time_s.push_back(static_cast<double>(k) * interval_s_);
    // The first sample's interval begins at t = 0, half way through it.
    history.force_N.push_back(impulse_[k] / interval_s_);
    if (history.force_N[k] > history.peak_force_N) {
      history.peak_force_N = history.force_N[k];
      history.peak_time_s = history.time_s[k];
    }
  }
  const double threshold_N = kContactShare * history.peak_force_N;
  for (std::size_t k = 0; k < samples; ++k) {
    if (history.force_N[k] > threshold_N) {
      above_from_s = above_from_s < 0.0 ? history.time_s[k] : above_from_s;
      history.contact_time_s = history.time_s[k] - above_from_s;
    }
  }
  history.contact_radius_m = std::move(radius_m_);
  history.probe_strain = std::move(probe_strain_);
  history.gauge_strain = std::move(gauge_strain_);
  history.fields = std::move(fields_);
  history.strained_share = std::move(strained_share_);
  history.falling_share = std::move(falling_share_);
  history.largest_contact_radius_m = largest_radius_m_;
  return history;
}

}  // namespace kolsky::impact
