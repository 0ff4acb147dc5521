#pragma once

#include <optional>
#include <span>
#include <vector>

#include "processing/criticism/fitting/fixed_point.hpp"
#include "processing/models/transfers.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// By step of a specimen's histories (`SpecimenScene::further_strain`).
struct SpecimenHistories {
  std::vector<double> stress_Pa;
  std::vector<double> strain;
};

/// The strain q(t) by which a specimen departs from its linear law under one shot's source, found
/// with the source: the reference gauge has seen what q sent there, too. What is bent is not the
/// filtered wave: the source is smooth and passes the records' filter, the specimen's answer to it
/// need not. So q is found unfiltered from the filtered source, and what it sends to the gauges is
/// filtered.
///   stiffening   spring strain sigma/E1 -> sigma / (E1 (1 + b e))
///   friction     material stress = measured / (1 + mu d / 3h), current d and h
///   gap          bars approach by delta before the specimen is loaded, and again if it reopens;
///   dry
///                faces part wherever the specimen would be pulled, and it recovers by itself
///   lateral      - m strain'^2 / 16 of the stress is inertia (its linear part is in the transfers)
///   further      a given history
class SpecimenResponse {
 public:
  /// @param transfers   reading relative to the reference's, except the reference's own
  /// @param source      record of the reference gauge, on the scene's path
  void solve(const Scene& scene, const Transfers& transfers, std::size_t reference,
             const std::vector<Complex>& source, std::span<const Complex> filter,
             DampedTransform& transform);

  [[nodiscard]] const std::vector<Complex>& q() const { return q_; }
  /// At the last solution, over the transform's length.
  [[nodiscard]] SpecimenHistories histories(DampedTransform& transform);

 private:
  /// A history's spectrum is a source's and so much more for each unit of q.
  struct Linear {
    std::vector<Complex> of_source;
    std::vector<Complex> of_q;
  };

  void prepare(const Scene& scene, const Transfers& transfers, std::size_t reference,
               const std::vector<Complex>& source, std::span<const Complex> filter);
  void give(const std::vector<double>& further_strain, DampedTransform& transform);
  void put_history(const Linear& linear, DampedTransform& transform, std::vector<double>& out);
  void depart(const Scene& scene, DampedTransform& transform);
  void bend(const Scene& scene, DampedTransform& transform);
  void accelerate(const Scene& scene, DampedTransform& transform);
  void rub(const SpecimenScene& specimen);
  void stiffen(const SpecimenScene& specimen);
  void part(const SpecimenScene& specimen, DampedTransform& transform);
  void close_gap(const SpecimenScene& specimen);
  void push_only(const SpecimenScene& specimen, double period_s);
  void to_time(const std::vector<Complex>& spectrum, DampedTransform& transform,
               std::vector<double>& out);
  void to_spectrum(const std::vector<double>& record, DampedTransform& transform,
                   std::vector<Complex>& out);

  Linear of_stress_, of_strain_;
  std::vector<Complex> of_lateral_;   ///< stress of lateral inertia, of strain
  std::vector<Complex> of_extra_;     ///< q of strain beside the material's
  std::vector<Complex> of_material_;  ///< q of stress that the material has beside the measured
  std::vector<Complex> given_;        ///< q of the given history
  std::vector<Complex> q_, next_, nearest_, wide_, spectrum_, sideways_;
  std::vector<double> stress_, strain_, rate_, accelerated_, extra_, material_;
  std::vector<double> apart_;  ///< the gap's share of q
  std::optional<std::size_t> at_rest_;
  FixedPoint steps_;
};

}  // namespace kolsky
