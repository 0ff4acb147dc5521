#pragma once

#include "processing/impact/body.hpp"
#include "processing/impact/contact.hpp"
#include "processing/impact/impact_history.hpp"
#include "processing/impact/impact_model.hpp"

namespace kolsky::impact {

/// Writes an impact's histories down while it runs. Its room is taken when it is made.
class Observer {
 public:
  Observer(const ImpactModel& model, const Body& ball, double longest_s);

  /// A step's forces, at `time_s`, which stand for the `width_s` round it.
  void add(double time_s, double width_s, const ContactSums& touch, const Body& ball,
           const Body* bar);

  /// What was seen, with the numbers that follow from it.
  [[nodiscard]] ImpactHistory history();

 private:
  struct Patch {
    std::vector<ElementIndex> elements;
    std::vector<double> weights;
  };
  void spread(double from_s, double to_s, double force_N);
  void look(const Body& ball, const Body* bar, double radius_m);
  void keep_fields(double time_s, const Body& ball);
  void watch_turn(double time_s, const Body& ball);
  [[nodiscard]] static Patch patch_round(const Body& ball, const Probe& probe);
  [[nodiscard]] static double bar_strain(const Body& bar, double position_m);

  double interval_s_;
  std::vector<double> impulse_;
  std::vector<double> radius_m_;
  std::vector<Patch> patches_;
  std::vector<std::vector<double>> probe_strain_;
  std::vector<double> positions_m_;
  std::vector<std::vector<double>> gauge_strain_;
  std::vector<double> field_times_s_;
  bool field_at_turn_;
  double last_s_ = 0.0;
  double largest_radius_m_ = 0.0;
  bool turned_ = false;
  std::vector<double> small_strain_;  ///< by layer: to which its law was identified
  std::vector<double> strained_share_;
  std::vector<double> falling_strain_;  ///< by layer: from which its law's stress falls
  std::vector<double> falling_share_;
  std::vector<Field> fields_;
};

}  // namespace kolsky::impact
