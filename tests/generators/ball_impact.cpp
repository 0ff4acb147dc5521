#include "tests/generators/ball_impact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace kolsky::testing {

namespace {

constexpr double kPi = std::numbers::pi;

struct Arm {
  double share = 0.0;  ///< of the modulus at once
  double time_s = 1.0;
};

/// E(t)/E(0) = relaxed + sum share e^(-t/time), from the zeros of J(s) between its poles.
struct Relaxing {
  double modulus_Pa = 0.0;  ///< at once
  double relaxed = 1.0;
  std::array<Arm, 2> arms{};
};

Relaxing relaxing(const BallSolid& solid) {
  const double t1 = solid.eta2_Pa_s / solid.E2_Pa;
  const double D1 = 1.0 / solid.E2_Pa;
  const bool two = solid.D_per_Pa > 0.0;
  const double t2 = two ? solid.tau_s : 0.0;
  const double D2 = two ? solid.D_per_Pa : 0.0;
  const double J0 = 1.0 / solid.E1_Pa;
  Relaxing out;
  out.modulus_Pa = solid.E1_Pa;
  out.relaxed = J0 / (J0 + D1 + D2);
  // J(s) (1+s t1)(1+s t2) = a s^2 + b s + c; E(s) has poles where it vanishes.
  const double a = J0 * t1 * t2;
  const double b = J0 * (t1 + t2) + D1 * t2 + D2 * t1;
  const double c = J0 + D1 + D2;
  std::array<double, 2> roots{-c / b, -c / b};
  if (two) {
    const double root = std::sqrt(b * b - 4.0 * a * c);
    roots = {(-b + root) / (2.0 * a), (-b - root) / (2.0 * a)};
  }
  for (std::size_t i = 0; i < (two ? 2U : 1U); ++i) {
    const double s = roots[i];
    // Residue of 1/(s J) at s, over E(0).
    const double numerator = (1.0 + s * t1) * (1.0 + s * t2);
    const double slope = two ? 2.0 * a * s + b : b;
    out.arms[i] = {J0 * numerator / (s * slope), -1.0 / s};
  }
  return out;
}

struct Tensor {  // axisymmetric, symmetric
  double rr = 0.0, zz = 0.0, tt = 0.0, rz = 0.0;
};

/// Turned by Jaumann's rate through the spin w dt.
Tensor turned(const Tensor& a, double w_dt) {
  return {a.rr + 2.0 * w_dt * a.rz, a.zz - 2.0 * w_dt * a.rz, a.tt, a.rz + w_dt * (a.zz - a.rr)};
}

struct Triangle {
  std::array<std::size_t, 3> node{};
  bool core = true;
  double volume0 = 0.0;  ///< over 2 pi
  double volume = 0.0;
  Tensor strain;  ///< deviatoric, logarithmic along the way
  std::array<Tensor, 2> arm;
  double theta = 0.0;
  double most = 0.0;  ///< largest equivalent strain so far
  std::array<double, 2> arm_pressure{};
};

class Strike {
 public:
  explicit Strike(const BallImpact& impact)
      : impact_(impact), core_(relaxing(impact.core)), cover_(relaxing(impact.cover)) {
    make_nodes();
    make_triangles();
    for (const Triangle& t : triangles_) {
      const double density = (t.core ? impact.core : impact.cover).density_kg_m3;
      for (const std::size_t n : t.node) {
        mass_[n] += 2.0 * kPi * t.volume0 * density / 3.0;
      }
    }
    choose_step();
  }

  BallForce go() {
    BallForce out;
    out.period_s = 1e-6;
    const double mass = total_mass();
    double impulse = 0.0;
    double binned = 0.0;  // impulse up to the last full microsecond
    double quiet_s = 0.0;
    constexpr double kGone_s = 30e-6;
    constexpr double kLongest_s = 2e-3;
    for (double time_s = 0.0; quiet_s < kGone_s; time_s += dt_) {
      if (time_s > kLongest_s) {
        throw std::runtime_error("the ball does not leave");
      }
      std::fill(fr_.begin(), fr_.end(), 0.0);
      std::fill(fz_.begin(), fz_.end(), 0.0);
      for (Triangle& t : triangles_) {
        stress(t);
      }
      const double force = contact();
      follow();
      quiet_s = force > 0.0 || time_s < 100e-6 ? 0.0 : quiet_s + dt_;
      for (std::size_t n = 0; n < r_.size(); ++n) {
        vr_[n] += fr_[n] / mass_[n] * dt_;
        vz_[n] += fz_[n] / mass_[n] * dt_;
        vr_[n] = on_axis_[n] ? 0.0 : vr_[n];
        r_[n] += vr_[n] * dt_;
        z_[n] += vz_[n] * dt_;
      }
      plane_m_ -= force / impact_.impedance_kg_per_s * dt_;
      // Means over a microsecond, from where the impulse is at its full multiples.
      impulse += force * dt_;
      while ((static_cast<double>(out.force_N.size()) + 1.0) * out.period_s <= time_s + dt_) {
        const double full_s = (static_cast<double>(out.force_N.size()) + 1.0) * out.period_s;
        const double there = impulse - force * (time_s + dt_ - full_s);
        out.force_N.push_back((there - binned) / out.period_s);
        binned = there;
      }
    }
    double momentum = 0.0;
    for (std::size_t n = 0; n < r_.size(); ++n) {
      momentum += mass_[n] * vz_[n];
    }
    out.rebound_m_per_s = momentum / mass;
    return out;
  }

 private:
  [[nodiscard]] double total_mass() const {
    double sum = 0.0;
    for (const double m : mass_) {
      sum += m;
    }
    return sum;
  }

  std::size_t add_node(double r, double z) {
    r_.push_back(r);
    z_.push_back(z);
    on_axis_.push_back(r < 1e-12);
    return r_.size() - 1;
  }

  /// A bulged square of n x 2n cells inside rings of 4n, the core's edge on one of them.
  void make_nodes() {
    const std::size_t n = impact_.across;
    const double R = impact_.outer_diameter_m / 2.0;
    const double a = 0.5 * impact_.core_diameter_m / 2.0;
    const auto bulged = [&](double u, double v) {
      const double bulge = 1.0 + 0.22 * (1.0 - std::max(u * u, v * v)) +
                           0.22 * (1.0 - std::min(u * u, v * v)) * std::max(u * u, v * v);
      return std::array<double, 2>{a * u * bulge, a * v * bulge};
    };
    grid_.assign(n + 1, std::vector<std::size_t>(2 * n + 1));
    for (std::size_t i = 0; i <= n; ++i) {
      for (std::size_t j = 0; j <= 2 * n; ++j) {
        const auto p = bulged(static_cast<double>(i) / static_cast<double>(n),
                              static_cast<double>(j) / static_cast<double>(n) - 1.0);
        grid_[i][j] = add_node(p[0], p[1]);
      }
    }
    std::vector<std::size_t> inner;
    for (std::size_t i = 0; i < n; ++i) {
      inner.push_back(grid_[i][0]);
    }
    for (std::size_t j = 0; j < 2 * n; ++j) {
      inner.push_back(grid_[n][j]);
    }
    for (std::size_t i = n + 1; i-- > 0;) {
      inner.push_back(grid_[i][2 * n]);
    }
    rings_.push_back(inner);
    const std::size_t in_core = n;
    const std::size_t in_cover = std::max<std::size_t>(3, n / 2);
    const double Rc = impact_.core_diameter_m / 2.0;
    core_rings_ = in_core;
    for (std::size_t k = 1; k <= in_core + in_cover; ++k) {
      std::vector<std::size_t> ring;
      for (std::size_t i = 0; i < inner.size(); ++i) {
        const double angle =
            kPi * (static_cast<double>(i) / static_cast<double>(inner.size() - 1) - 0.5);
        const double c = i == 0 || i + 1 == inner.size() ? 0.0 : std::cos(angle);
        const double s = std::sin(angle);
        if (k <= in_core) {
          const double w = static_cast<double>(k) / static_cast<double>(in_core);
          ring.push_back(add_node((1.0 - w) * r_[inner[i]] + w * Rc * c,
                                  (1.0 - w) * z_[inner[i]] + w * Rc * s));
        } else {
          const double w = static_cast<double>(k - in_core) / static_cast<double>(in_cover);
          const double radius = Rc + w * (R - Rc);
          ring.push_back(add_node(radius * c, radius * s));
        }
      }
      rings_.push_back(std::move(ring));
    }
    surface_ = rings_.back();
    plane_m_ = z_[surface_.front()];
    sabot_m_ = z_[surface_.back()];
    sabot_speed_m_per_s_ = -impact_.speed_m_per_s;
    for (std::size_t i = 0; i < surface_.size(); ++i) {
      const std::size_t before = surface_[i == 0 ? i : i - 1];
      const std::size_t after = surface_[std::min(i + 1, surface_.size() - 1)];
      const double length_m = 0.5 * std::hypot(r_[after] - r_[before], z_[after] - z_[before]);
      area_m2_.push_back(2.0 * kPi * r_[surface_[i]] * length_m);
    }
  }

  void cut(std::array<std::size_t, 4> quad, bool core) {
    const std::size_t middle =
        add_node(0.25 * (r_[quad[0]] + r_[quad[1]] + r_[quad[2]] + r_[quad[3]]),
                 0.25 * (z_[quad[0]] + z_[quad[1]] + z_[quad[2]] + z_[quad[3]]));
    on_axis_[middle] = false;
    for (std::size_t k = 0; k < 4; ++k) {
      Triangle t;
      t.node = {quad[k], quad[(k + 1) % 4], middle};
      t.core = core;
      t.volume0 = t.volume = std::abs(doubled_area(t)) / 2.0 * mean_radius(t);
      if (doubled_area(t) < 0.0) {
        std::swap(t.node[0], t.node[1]);
      }
      triangles_.push_back(t);
    }
  }

  void make_triangles() {
    const std::size_t n = impact_.across;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < 2 * n; ++j) {
        cut({grid_[i][j], grid_[i + 1][j], grid_[i + 1][j + 1], grid_[i][j + 1]}, true);
      }
    }
    for (std::size_t k = 0; k + 1 < rings_.size(); ++k) {
      for (std::size_t i = 0; i + 1 < rings_[k].size(); ++i) {
        cut({rings_[k][i], rings_[k + 1][i], rings_[k + 1][i + 1], rings_[k][i + 1]},
            k < core_rings_);
      }
    }
    const std::size_t nodes = r_.size();
    vr_.assign(nodes, 0.0);
    vz_.assign(nodes, -impact_.speed_m_per_s);
    fr_.assign(nodes, 0.0);
    fz_.assign(nodes, 0.0);
    mass_.assign(nodes, 0.0);
  }

  [[nodiscard]] double doubled_area(const Triangle& t) const {
    const auto [a, b, c] = t.node;
    return (r_[b] - r_[a]) * (z_[c] - z_[a]) - (r_[c] - r_[a]) * (z_[b] - z_[a]);
  }
  [[nodiscard]] double mean_radius(const Triangle& t) const {
    return (r_[t.node[0]] + r_[t.node[1]] + r_[t.node[2]]) / 3.0;
  }

  void choose_step() {
    double least = 1.0;
    for (const Triangle& t : triangles_) {
      const BallSolid& solid = t.core ? impact_.core : impact_.cover;
      const double nu = solid.poisson_ratio;
      const double stiff = solid.E1_Pa * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
      const double speed =
          std::sqrt(stiff * (1.0 + std::max(0.0, 0.5 * solid.b)) / solid.density_kg_m3);
      double longest = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t a = t.node[k];
        const std::size_t b = t.node[(k + 1) % 3];
        longest = std::max(longest, std::hypot(r_[a] - r_[b], z_[a] - z_[b]));
      }
      least = std::min(least, doubled_area(t) / longest / speed);
    }
    constexpr double kSafe = 0.35;  // elements are squeezed to half
    dt_ = kSafe * least;
    double lightest = 1.0;
    for (const std::size_t n : surface_) {
      lightest = std::min(lightest, mass_[n] / std::max(r_[n], 1e-4));
    }
    // Stiffness per node over its mass, well below the step's limit.
    penalty_per_s2_ = 0.02 / (dt_ * dt_);
  }

  void stress(Triangle& t) {
    const auto [a, b, c] = t.node;
    const double area2 = doubled_area(t);
    const double radius = mean_radius(t);
    const double volume = 0.5 * area2 * radius;
    if (!(area2 > 0.0) || !std::isfinite(volume)) {
      throw std::runtime_error("a triangle turned over");
    }
    const std::array<double, 3> gr{(z_[b] - z_[c]) / area2, (z_[c] - z_[a]) / area2,
                                   (z_[a] - z_[b]) / area2};
    const std::array<double, 3> gz{(r_[c] - r_[b]) / area2, (r_[a] - r_[c]) / area2,
                                   (r_[b] - r_[a]) / area2};
    double Lrr = 0.0, Lrz = 0.0, Lzr = 0.0, Lzz = 0.0, vr = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t n = t.node[k];
      Lrr += gr[k] * vr_[n];
      Lrz += gz[k] * vr_[n];
      Lzr += gr[k] * vz_[n];
      Lzz += gz[k] * vz_[n];
      vr += vr_[n] / 3.0;
    }
    const double Ltt = vr / radius;
    const double trace = Lrr + Lzz + Ltt;
    const double w_dt = 0.5 * (Lrz - Lzr) * dt_;
    const BallSolid& solid = t.core ? impact_.core : impact_.cover;
    const Relaxing& law = t.core ? core_ : cover_;
    const double G = law.modulus_Pa / (2.0 * (1.0 + solid.poisson_ratio));
    const double K = law.modulus_Pa / (3.0 * (1.0 - 2.0 * solid.poisson_ratio));
    const Tensor before = turned(t.strain, w_dt);
    Tensor& e = t.strain;
    e = {before.rr + (Lrr - trace / 3.0) * dt_, before.zz + (Lzz - trace / 3.0) * dt_,
         before.tt + (Ltt - trace / 3.0) * dt_, before.rz + 0.5 * (Lrz + Lzr) * dt_};
    const double stiff_before = stiffness(solid, before, t.most);
    t.most = std::max(t.most, equivalent(e));
    const double stiff_now = stiffness(solid, e, t.most);
    const double grown = trace * dt_;
    t.theta += grown;
    Tensor s{2.0 * G * law.relaxed * stiff_now * e.rr, 2.0 * G * law.relaxed * stiff_now * e.zz,
             2.0 * G * law.relaxed * stiff_now * e.tt, 2.0 * G * law.relaxed * stiff_now * e.rz};
    double mean = K * law.relaxed * t.theta;
    for (std::size_t k = 0; k < 2; ++k) {
      if (law.arms[k].share == 0.0) {
        continue;
      }
      const double fade = std::exp(-dt_ / law.arms[k].time_s);
      const double gain = 2.0 * G * law.arms[k].share * (1.0 - 0.5 * dt_ / law.arms[k].time_s);
      Tensor& q = t.arm[k];
      q = turned(q, w_dt);
      q = {q.rr * fade + gain * (stiff_now * e.rr - stiff_before * before.rr),
           q.zz * fade + gain * (stiff_now * e.zz - stiff_before * before.zz),
           q.tt * fade + gain * (stiff_now * e.tt - stiff_before * before.tt),
           q.rz * fade + gain * (stiff_now * e.rz - stiff_before * before.rz)};
      s = {s.rr + q.rr, s.zz + q.zz, s.tt + q.tt, s.rz + q.rz};
      t.arm_pressure[k] = t.arm_pressure[k] * fade +
                          K * law.arms[k].share * grown * (1.0 - 0.5 * dt_ / law.arms[k].time_s);
      mean += t.arm_pressure[k];
    }
    t.volume = volume;
    const double whole = 2.0 * kPi * volume;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t n = t.node[k];
      fr_[n] -= whole * ((s.rr + mean) * gr[k] + s.rz * gz[k] + (s.tt + mean) / (3.0 * radius));
      fz_[n] -= whole * (s.rz * gr[k] + (s.zz + mean) * gz[k]);
    }
  }

  static double equivalent(const Tensor& e) {
    return std::sqrt(2.0 / 3.0 * (e.rr * e.rr + e.zz * e.zz + e.tt * e.tt + 2.0 * e.rz * e.rz));
  }

  /// Over the linear one's.
  static double stiffness(const BallSolid& solid, const Tensor& e, double most) {
    return (1.0 + solid.b * equivalent(e)) * (1.0 - solid.damage * most);
  }

  /// Of a circle about the ball's axis, by counting along it.
  [[nodiscard]] double share_on_target(double radius_m) const {
    if (impact_.offset_m == 0.0) {
      return radius_m > impact_.target_radius_m ? 0.0 : 1.0;
    }
    constexpr int kPoints = 256;
    int on = 0;
    for (int i = 0; i < kPoints; ++i) {
      const double angle = kPi * (i + 0.5) / kPoints;
      on += std::hypot(radius_m * std::cos(angle) + impact_.offset_m, radius_m * std::sin(angle)) <
                    impact_.target_radius_m
                ? 1
                : 0;
    }
    return static_cast<double>(on) / kPoints;
  }

  /// How far a pressure of one presses the cover together where it relaxes and cannot spread.
  [[nodiscard]] double cover_gives_m_per_Pa() const {
    const BallSolid& cover = impact_.cover;
    const double relaxed_Pa = 1.0 / (1.0 / cover.E1_Pa + 1.0 / cover.E2_Pa + cover.D_per_Pa);
    const double nu = cover.poisson_ratio;
    const double thickness_m = 0.5 * (impact_.outer_diameter_m - impact_.core_diameter_m);
    return thickness_m * (1.0 + nu) * (1.0 - 2.0 * nu) / ((1.0 - nu) * relaxed_Pa);
  }

  /// The force on a circle of the surface whose mean lies `depth_m` in the plane: what overhangs is
  /// a bed of springs, the cover in its thickness, that is let go. (The solver's free arc moves as
  /// a half-space does over the width of its overhang, and its edge presses outwards as it yields.)
  [[nodiscard]] double push_N(std::size_t i, double depth_m) const {
    const std::size_t n = surface_[i];
    const double share = share_on_target(r_[n]);
    const double held_N = penalty_per_s2_ * mass_[n] * depth_m;
    if (share == 1.0 || share == 0.0 || held_N <= 0.0) {
      return share * held_N;
    }
    const double let_go_m = (1.0 - share) / share * cover_gives_m_per_Pa() * held_N / area_m2_[i];
    return held_N * depth_m / (depth_m + let_go_m);
  }

  double contact() {
    double force = 0.0;
    for (std::size_t i = 0; i < surface_.size() / 2; ++i) {
      const std::size_t n = surface_[i];
      const double depth = plane_m_ - z_[n];
      const double push = depth > 0.0 ? push_N(i, depth) : 0.0;
      if (push == 0.0) {
        continue;
      }
      fz_[n] += push;
      force += push;
      // Coulomb, as much as stops the slip at most.
      const double stop = -(vr_[n] + fr_[n] / mass_[n] * dt_) * mass_[n] / dt_;
      fr_[n] += std::clamp(stop, -impact_.friction * push, impact_.friction * push);
    }
    return force;
  }

  /// The sabot's push on the ball's rear, without friction.
  void follow() {
    if (impact_.sabot_mass_kg == 0.0) {
      return;
    }
    double push_N = 0.0;
    for (std::size_t i = surface_.size() / 2; i < surface_.size(); ++i) {
      const std::size_t n = surface_[i];
      const double held_N = std::max(0.0, penalty_per_s2_ * mass_[n] * (z_[n] - sabot_m_));
      fz_[n] -= held_N;
      push_N += held_N;
    }
    sabot_speed_m_per_s_ += push_N / impact_.sabot_mass_kg * dt_;
    sabot_m_ += sabot_speed_m_per_s_ * dt_;
  }

  BallImpact impact_;
  Relaxing core_, cover_;
  std::vector<double> r_, z_, vr_, vz_, fr_, fz_, mass_;
  std::vector<char> on_axis_;
  std::vector<std::vector<std::size_t>> grid_;
  std::vector<std::vector<std::size_t>> rings_;
  std::size_t core_rings_ = 0;
  std::vector<std::size_t> surface_;
  std::vector<double> area_m2_;  ///< of each of the surface's nodes, undeformed
  std::vector<Triangle> triangles_;
  double plane_m_ = 0.0;
  double sabot_m_ = 0.0;
  double sabot_speed_m_per_s_ = 0.0;
  double penalty_per_s2_ = 0.0;
  double dt_ = 0.0;
};

}  // namespace

BallForce strike(const BallImpact& impact) {
  return Strike(impact).go();
}

}  // namespace kolsky::testing
