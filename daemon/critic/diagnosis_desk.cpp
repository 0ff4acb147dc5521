#include "daemon/critic/diagnosis_desk.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <set>

#include "daemon/clock.hpp"
#include "daemon/critic/diagnosis_message.hpp"
#include "daemon/log.hpp"
#include "daemon/shots/shot_id.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/models/diagnosis_step.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "processing/criticism/experiment/next_experiment.hpp"
#include "processing/criticism/impact/impact_diagnosis.hpp"
#include "processing/criticism/search/confirmed_hum.hpp"
#include "processing/criticism/verdict/examination.hpp"

namespace kolsky {

namespace {

constexpr mode_t kStoredMode = 0644;
constexpr int kLowestPriority = 19;

/// Unwinds a diagnosis that nobody wants any more.
struct Cancelled {};

/// Of Linux: the nice value is a thread's own.
void run_last() {
  static_cast<void>(setpriority(PRIO_PROCESS, 0, kLowestPriority));
}

/// Before anything begins: a run that fails would stand in the place of the last one.
void require_stored(Archivist& archivist, const std::vector<std::string>& ids) {
  if (ids.empty()) {
    return;
  }
  std::set<std::string> stored;
  for (const CatalogueEntry& entry : archivist.newest(0)) {
    stored.insert(entry.id);
  }
  for (const std::string& id : ids) {
    if (!stored.contains(id)) {
      throw InputError("shot " + id, "is not in the store", "`kolsky shots` lists what is");
    }
  }
}

std::vector<std::string> chosen(Archivist& archivist, const v1::Diagnose& request) {
  std::vector<std::string> ids(request.ids().begin(), request.ids().end());
  if (ids.size() > DiagnosisDesk::kMostShots || request.shots() > DiagnosisDesk::kMostShots) {
    throw InputError("diagnose", "too many shots are asked for",
                     fmt::format("name at most {}", DiagnosisDesk::kMostShots));
  }
  if (std::set<std::string>(ids.begin(), ids.end()).size() != ids.size()) {
    throw InputError("diagnose: ids", "one is named twice", "name each shot once");
  }
  require_stored(archivist, ids);
  if (ids.empty()) {
    const std::size_t most = request.shots() == 0 ? DiagnosisDesk::kUsualShots : request.shots();
    for (const CatalogueEntry& entry : archivist.newest(most)) {
      ids.push_back(entry.id);
    }
    std::reverse(ids.begin(), ids.end());
  }
  if (ids.empty()) {
    throw InputError("diagnose", "the store holds no shots", "take some first");
  }
  return ids;
}

}  // namespace

DiagnosisDesk::DiagnosisDesk(Publisher& publisher, Archivist& archivist, StoreLayout store)
    : publisher_(publisher), archivist_(archivist), store_(std::move(store)) {}

DiagnosisDesk::~DiagnosisDesk() {
  stop();
}

void DiagnosisDesk::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    cancel_.store(true);
  }
  const std::lock_guard begins(begin_mutex_);
  thread_.join();
}

void DiagnosisDesk::begin(std::shared_ptr<const ActiveModel> model, const v1::Diagnose& request,
                          v1::Diagnosis& begun) {
  if (!model) {
    throw InputError("diagnose", "no model is active",
                     "name one in the configuration: [model] file, then reload");
  }
  const std::lock_guard begins(begin_mutex_);
  {
    const std::lock_guard lock(mutex_);
    if (stopped_) {
      throw InputError("diagnose", "kolskyd is ending", "ask again once it runs");
    }
    if (under_way()) {
      throw InputError("diagnose", "one is under way: " + last_->summary().id(),
                       "wait for it, or cancel it");
    }
  }
  const std::vector<std::string> ids = chosen(archivist_, request);
  thread_.join();
  {
    const std::lock_guard lock(mutex_);
    cancel_.store(stopped_);
    last_ = std::make_unique<v1::Diagnosis>();
    last_->mutable_summary()->set_id(fmt::format("{}-{:04x}-{}",
                                                 format_utc_compact(clock_ns(CLOCK_REALTIME)),
                                                 publisher_.boot_id() & 0xffff, ++count_));
    last_->mutable_summary()->set_state(v1::DiagnosisSummary::RUNNING);
    last_->mutable_summary()->set_step("waiting");
    last_->mutable_shots()->Add(ids.begin(), ids.end());
    last_->set_model_path(model->path.string());
    last_->set_model_sha256(model->sha256);
    begun = *last_;
  }
  thread_ = Thread("kolsky-diagnose", [this, model = std::move(model), ids] { work(model, ids); });
}

void DiagnosisDesk::cancel() {
  const std::lock_guard lock(mutex_);
  if (!under_way()) {
    throw InputError("cancel", "no diagnosis is under way", "nothing needs to be done");
  }
  cancel_.store(true);
}

/// What has been seen to end is not under way, however long its thread takes to leave.
bool DiagnosisDesk::under_way() const {
  return last_ && last_->summary().state() == v1::DiagnosisSummary::RUNNING;
}

bool DiagnosisDesk::last(v1::Diagnosis& diagnosis) const {
  const std::lock_guard lock(mutex_);
  if (!last_) {
    return false;
  }
  diagnosis = *last_;
  return true;
}

void DiagnosisDesk::heed_cancel() const {
  if (cancel_.load()) {
    throw Cancelled{};
  }
}

void DiagnosisDesk::publish(const std::function<void(v1::Diagnosis&)>& change) {
  v1::Diagnosis message;
  {
    const std::lock_guard lock(mutex_);
    change(*last_);
    message = *last_;
  }
  publisher_.publish_diagnosis(message);
}

void DiagnosisDesk::step(const std::string& what) {
  heed_cancel();
  publish([&](v1::Diagnosis& message) { message.mutable_summary()->set_step(what); });
}

void DiagnosisDesk::work(const std::shared_ptr<const ActiveModel>& model,
                         const std::vector<std::string>& ids) {
  run_last();
  const auto end = [&](v1::DiagnosisSummary::State state, const std::string& step) {
    publish([&](v1::Diagnosis& message) {
      message.mutable_summary()->set_state(state);
      message.mutable_summary()->set_step(step);
    });
    log::info("diagnosis: " + step);
  };
  try {
    examine(*model, ids);
    end(v1::DiagnosisSummary::DONE, "done");
  } catch (const Cancelled&) {
    v1::Diagnosis now;
    (void)last(now);
    end(v1::DiagnosisSummary::CANCELLED, "while " + now.summary().step());
  } catch (const std::exception& error) {
    end(v1::DiagnosisSummary::FAILED, error.what());
  }
}

void DiagnosisDesk::examine(const ActiveModel& model, const std::vector<std::string>& ids) {
  std::vector<Shot> shots;
  std::vector<std::filesystem::path> captures;
  for (const std::string& id : ids) {
    step("reading " + id);
    StoredShot stored = archivist_.get(id);
    shots.push_back(std::move(stored.shot));
    captures.push_back(std::move(stored.capture));
  }
  if (const auto verdict = verdict_without_fit(shots)) {
    file(model, *verdict, {}, captures);
    return;
  }
  const Campaign campaign = read_campaign(shots);
  Workers one;
  one.run = [this](std::size_t count, const std::function<void(std::size_t, std::size_t)>& task) {
    for (std::size_t index = 0; index < count; ++index) {
      heed_cancel();
      task(index, 0);
    }
  };
  DiagnosisOptions options;
  options.progress = [this](const std::string& what) { step(what); };
  if (campaign.bench.kind == BenchKind::impact) {
    ImpactStudy study(campaign, judged_stretch(model.file.model), 0.0, std::move(one));
    const Diagnosis diagnosis = diagnose_impacts(study, model.file.model, options);
    file(model, diagnosis, diagnosis.after, captures);
    return;
  }
  Study study(campaign, 0.0, std::move(one));
  Diagnosis diagnosis = diagnose(study, model.file.model, options);
  step("reckoning what would separate what is tied");
  diagnosis.next_experiment = next_experiments(study, diagnosis);
  // As `compare` has it; only what was found is kept with a model.
  const bool kept = diagnosis.model && !diagnosis.effects.empty();
  file(model, diagnosis, kept ? judged_as_it_is(study, *diagnosis.model).misfit : Misfit{},
       captures);
}

void DiagnosisDesk::file(const ActiveModel& model, const Diagnosis& diagnosis, const Misfit& left,
                         const std::vector<std::filesystem::path>& captures) {
  heed_cancel();
  v1::Diagnosis message;
  (void)last(message);
  fill(diagnosis, message);
  const std::filesystem::path folder = store_.root / "diagnoses";
  std::filesystem::create_directories(folder);
  const std::filesystem::path path = folder / (message.summary().id() + ".json");
  message.set_stored_as(path.string());
  message.mutable_summary()->set_state(v1::DiagnosisSummary::DONE);
  message.mutable_summary()->set_step("done");
  if (diagnosis.model && !diagnosis.effects.empty()) {
    ModelFile found = model.file;
    add_diagnosis(found, diagnosis, left, captures, "live, shots of " + store_.root.string());
    NewFile with(folder / (message.summary().id() + ".toml"));
    with.write(format_model(found));
    with.publish(kStoredMode);
  }
  NewFile outcome(path);
  outcome.write(json_of(message) + "\n");
  outcome.publish(kStoredMode);
  const std::lock_guard lock(mutex_);
  *last_ = message;
}

}  // namespace kolsky
