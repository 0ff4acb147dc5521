#pragma once

#include "tests/generators/rod1d.hpp"
#include "tests/generators/shpb_world.hpp"

namespace kolsky::testing {

/// What stands between the two bars. Each step it closes the input bar's right end and the output
/// bar's left end.
class ShpbContact {
 public:
  virtual ~ShpbContact() = default;
  virtual void close(Rod& input, Rod& output) = 0;
  [[nodiscard]] double force_N() const { return force_N_; }
  [[nodiscard]] double strain() const { return strain_; }

 protected:
  double force_N_ = 0.0;
  double strain_ = 0.0;
};

/// A specimen without mass: shortening and force follow from its material by an implicit step of
/// second order, solved by the secant method.
class MasslessSpecimen : public ShpbContact {
 public:
  MasslessSpecimen(const ShpbWorld& world, double step_s);
  void close(Rod& input, Rod& output) override;

 private:
  struct Trial {
    double stress;
    double force_N;
    double strain_rate;
  };
  [[nodiscard]] Trial at(double strain) const;
  /// Done on it per volume until a strain and a stress are reached.
  [[nodiscard]] double work_by(double strain, double stress) const;
  [[nodiscard]] double extra_shortening(double force_N) const;
  void settle(const Trial& trial, double strain, double shortening, double shortening_rate);

  TrueSpecimen specimen_;
  double bar_area_m2_;
  double step_s_;
  KelvinStep chain_, punch_chain_;
  double punch_m_per_N_Pa_;  // shortening per force and compliance of the bars
  std::vector<double> viscous_, punch_viscous_;
  bool closed_ = false;  // the gap; once closed it stays so
  double stress_ = 0.0;
  double shortening_ = 0.0, shortening_rate_ = 0.0;
  double strain_before_ = 0.0, strain_before_that_ = 0.0;
  double largest_strain_ = 0.0;
  double work_J_per_m3_ = 0.0;
};

/// A specimen that waves cross: a rod of its own.
class WavySpecimen : public ShpbContact {
 public:
  WavySpecimen(const ShpbWorld& world, int cells);
  void close(Rod& input, Rod& output) override;

 private:
  Rod rod_;
  double area_share_;  // of the bar's
  double bar_area_m2_;
  double length_m_;
};

}  // namespace kolsky::testing
