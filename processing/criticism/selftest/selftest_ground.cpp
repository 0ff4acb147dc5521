#include "processing/criticism/selftest/selftest_ground.hpp"

#include "processing/base/error.hpp"
#include "processing/criticism/impact/impact_diagnosis.hpp"
#include "processing/criticism/selftest/ball_planting.hpp"
#include "processing/criticism/selftest/planting.hpp"

namespace kolsky {

namespace {

class BarGround final : public SelftestGround {
 public:
  BarGround(const std::vector<Shot>& shots, const Model& model, double band_limit_Hz,
            const Workers& workers)
      : model_(model),
        band_limit_Hz_(band_limit_Hz),
        workers_(workers),
        campaign_(read_campaign(shots)),
        study_(campaign_, band_limit_Hz, workers),
        studied_(study_.fit(model)),
        planter_(shots, study_, studied_) {}

  [[nodiscard]] Diagnosis untouched() const override {
    Study study(campaign_, band_limit_Hz_, workers_);
    return diagnose(study, model_, {});
  }
  [[nodiscard]] Diagnosis diagnosed(const std::vector<Shot>& shots) const override {
    const Campaign campaign = read_campaign(shots);
    Study study(campaign, band_limit_Hz_, Workers{});
    return diagnose(study, model_, {});
  }
  [[nodiscard]] std::string impossible_because(const EffectUse& use) const override {
    return planter_.impossible_because(use);
  }
  [[nodiscard]] std::vector<Shot> planted(const EffectUse& use, std::size_t) const override {
    return planter_.planted(use);
  }
  [[nodiscard]] std::vector<Shot> drawn_anew(std::uint64_t seed, std::size_t) const override {
    return planter_.drawn_anew(seed);
  }

 private:
  const Model& model_;
  double band_limit_Hz_;
  const Workers& workers_;
  Campaign campaign_;
  Study study_;
  Studied studied_;
  Planter planter_;
};

class BallGround final : public SelftestGround {
 public:
  BallGround(const std::vector<Shot>& shots, const Model& model, double band_limit_Hz,
             const BallMeshes& meshes, const Workers& workers)
      : model_(model),
        band_limit_Hz_(band_limit_Hz),
        meshes_(meshes),
        workers_(workers),
        campaign_(read_campaign(shots)),
        runs_(std::make_shared<BallRuns>(campaign_.bench)),
        study_(campaign_, judged_stretch(model), band_limit_Hz, workers, meshes, runs_),
        studied_(study_.settled(study_.fit(model))),
        planter_(shots, study_, studied_) {}

  [[nodiscard]] Diagnosis untouched() const override {
    ImpactStudy study(campaign_, judged_stretch(model_), band_limit_Hz_, workers_, meshes_, runs_);
    return diagnose_impacts(study, model_, {});
  }
  [[nodiscard]] Diagnosis diagnosed(const std::vector<Shot>& shots) const override {
    const Campaign campaign = read_campaign(shots);
    ImpactStudy study(campaign, judged_stretch(model_), band_limit_Hz_, Workers{}, meshes_, runs_);
    return diagnose_impacts(study, model_, {});
  }
  [[nodiscard]] std::string impossible_because(const EffectUse& use) const override {
    return planter_.impossible_because(use);
  }
  [[nodiscard]] std::vector<Shot> planted(const EffectUse& use, std::size_t worker) const override {
    return planter_.planted(use, worker);
  }
  [[nodiscard]] std::vector<Shot> drawn_anew(std::uint64_t seed,
                                             std::size_t worker) const override {
    return planter_.drawn_anew(seed, worker);
  }

 private:
  const Model& model_;
  double band_limit_Hz_;
  BallMeshes meshes_;
  const Workers& workers_;
  Campaign campaign_;
  /// Every diagnosis begins with the same balls at the same speeds.
  std::shared_ptr<BallRuns> runs_;
  ImpactStudy study_;
  Studied studied_;
  BallPlanter planter_;
};

}  // namespace

std::unique_ptr<SelftestGround> ground_of(const std::vector<Shot>& shots, const Model& model,
                                          double band_limit_Hz, const BallMeshes& meshes,
                                          const Workers& workers) {
  if (!shots.empty() && shots.front().bench.kind != model.kind) {
    throw InputError(
        "the model",
        "is of a bench of kind " + name_of(model.kind) + ", and the captures of one of kind " +
            name_of(shots.front().bench.kind),
        "make one with `kolsky model new --kind " + name_of(shots.front().bench.kind) + "`");
  }
  if (model.kind == BenchKind::impact) {
    return std::make_unique<BallGround>(shots, model, band_limit_Hz, meshes, workers);
  }
  return std::make_unique<BarGround>(shots, model, band_limit_Hz, workers);
}

}  // namespace kolsky
