#include "processing/criticism/impact/impact_residuals.hpp"

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// A ball's force grows by the power 1.2 of its speed, and what its strain adds by about 2.
constexpr double kChangeBySpeed = 1.5;

}  // namespace

BallRun ImpactResiduals::force(Moves mesh, const BallScene& ball, std::size_t group,
                               const Anchor& anchor) {
  const SpeedGroup& own = records_.groups[group];
  const double growth = std::pow(anchor.speed_m_per_s / own.speed_m_per_s, kChangeBySpeed);
  const auto moved_from = [&](const BallRun& there, std::size_t elements) {
    const BallRun here = *runs_->run(ball, own.speed_m_per_s, elements);
    return sum_of(anchor.fine, growth, sum_of(here, -1.0, there));
  };
  if (mesh == Moves::coarse) {
    return sum_of(moved_from(anchor.coarse, meshes_.coarse), ball.cauchy_share, anchor.law);
  }
  const BallRun law = law_by(ball, own.speed_m_per_s, meshes_.middle);
  return sum_of(moved_from(anchor.middle, meshes_.middle), ball.cauchy_share,
                sum_of(anchor.law, growth, sum_of(law, -1.0, anchor.middle_law)));
}

/// Cauchy's less Kirchhoff's.
BallRun ImpactResiduals::law_by(const BallScene& ball, double speed_m_per_s, std::size_t elements) {
  return sum_of(*runs_->run(ball, speed_m_per_s, elements, LawForm::cauchy), -1.0,
                *runs_->run(ball, speed_m_per_s, elements, LawForm::kirchhoff));
}

void ImpactResiduals::anchor(const Composition& composition, const std::vector<double>& theta,
                             AnchorBy by) {
  BallScene ball;
  static_cast<void>(transfers(composition, theta, 0, ball));
  const bool finest = by == AnchorBy::fine;
  struct Task {
    double speed_m_per_s;
    std::size_t elements;
    LawForm form = LawForm::kirchhoff;
  };
  std::vector<Task> tasks;
  for (const SpeedGroup& group : records_.groups) {
    for (const double speed : {group.low_m_per_s, group.high_m_per_s}) {
      if (finest) {
        tasks.push_back({speed, meshes_.fine});
      }
      tasks.push_back({speed, meshes_.middle});
      tasks.push_back({speed, meshes_.middle, LawForm::cauchy});
    }
    tasks.push_back({group.speed_m_per_s, meshes_.coarse});
  }
  // The long ones first: no worker is left with one at the end.
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const Task& a, const Task& b) { return a.elements > b.elements; });
  const auto run = [&](const Task& task) {
    return runs_->run(ball, task.speed_m_per_s, task.elements, task.form);
  };
  executor_.run(tasks.size(),
                [&](std::size_t i, std::size_t) { static_cast<void>(run(tasks[i])); });
  anchored_at_ = theta;
  moves_ = Moves::coarse;
  anchors_.resize(records_.groups.size());
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const SpeedGroup& group = records_.groups[g];
    const BallRun coarse = *run({group.speed_m_per_s, meshes_.coarse});
    anchors_[g].low.speed_m_per_s = group.low_m_per_s;
    anchors_[g].high.speed_m_per_s = group.high_m_per_s;
    for (Anchor* own : {&anchors_[g].low, &anchors_[g].high}) {
      const BallRun middle = *run({own->speed_m_per_s, meshes_.middle});
      if (finest) {
        own->mesh = sum_of(*run({own->speed_m_per_s, meshes_.fine}), -1.0, middle);
      }
      own->fine = sum_of(middle, 1.0, own->mesh);
      own->coarse = coarse;
      own->law = law_by(ball, own->speed_m_per_s, meshes_.middle);
    }
  }
}

void ImpactResiduals::move_by(Moves mesh, const Composition& composition) {
  moves_ = mesh;
  if (mesh == Moves::coarse) {
    return;
  }
  BallScene ball;
  static_cast<void>(transfers(composition, anchored_at_, 0, ball));
  run_ahead(executor_, ball);
  for (std::size_t g = 0; g < records_.groups.size(); ++g) {
    const double speed = records_.groups[g].speed_m_per_s;
    const BallRun there = *runs_->run(ball, speed, meshes_.middle);
    const BallRun law = law_by(ball, speed, meshes_.middle);
    for (Anchor* own : {&anchors_[g].low, &anchors_[g].high}) {
      own->middle = there;
      own->middle_law = law;
    }
  }
}

/// The impacts that forces at these numbers are made of, shared out among workers.
void ImpactResiduals::run_ahead(const Workers& executor, const BallScene& ball) {
  const bool coarse = moves_ == Moves::coarse;
  const std::size_t laws = coarse ? 1 : 2;
  executor.run(laws * records_.groups.size(), [&](std::size_t i, std::size_t /*worker*/) {
    const double speed = records_.groups[i / laws].speed_m_per_s;
    const LawForm form = i % laws == 1 ? LawForm::cauchy : LawForm::kirchhoff;
    try {
      static_cast<void>(runs_->run(ball, speed, coarse ? meshes_.coarse : meshes_.middle, form));
    } catch (const InputError&) {
      // Refused again where it is asked for, and said there.
    }
  });
}

void ImpactResiduals::prepare(const Composition& composition, const std::vector<double>& theta) {
  solver_share_ = 1.0;
  anchor(composition, theta, AnchorBy::fine);
  Foretold foretold = foretell(composition, theta, executor_.first);
  if (!foretold.sound) {
    throw InputError("model", "has a ball that the solver refuses", "bring its numbers nearer");
  }
  touch_s_ = foretold.arrival_s;
  records_.judge_from(touch_s_);
  foretold = foretell(composition, theta, executor_.first);
  set_whitening(foretold, composition, theta);
}

}  // namespace kolsky
