#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>

#include "daemon/critic/active_model.hpp"
#include "daemon/publish/publisher.hpp"
#include "daemon/thread.hpp"
#include "processing/base/shot.hpp"

namespace kolsky {

/// The thread that compares each shot with the active model once its result is out, and publishes
/// what it found. Nobody waits for it: of shots that come faster than they can be compared the
/// oldest are left out, with a fault.
class ShotCritic {
 public:
  /// @param publisher  outlives this
  explicit ShotCritic(Publisher& publisher);
  ~ShotCritic();
  ShotCritic(const ShotCritic&) = delete;
  ShotCritic& operator=(const ShotCritic&) = delete;

  void start();
  /// Compares what waits, then ends.
  void stop();

  /// From any thread: for the shots to come; none: nothing is compared. The trend begins anew.
  void change(std::shared_ptr<const ActiveModel> model);
  /// From any thread; cheap.
  void compare(std::shared_ptr<const Shot> shot);

  [[nodiscard]] std::shared_ptr<const ActiveModel> model() const;
  /// The last comparison under the active model. @return whether there is one
  [[nodiscard]] bool last(v1::Comparison& comparison) const;
  [[nodiscard]] bool idle() const;

  static constexpr std::size_t kMostWaiting = 64;
  static constexpr std::size_t kTrend = 20;  ///< shots

 private:
  void run();
  void compare_now(const Shot& shot);

  Publisher& publisher_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const ActiveModel> model_;
  std::deque<std::shared_ptr<const Shot>> waiting_;
  std::deque<double> trend_;
  std::unique_ptr<v1::Comparison> last_;
  bool busy_ = false;
  bool stop_ = false;
  Thread thread_;
};

}  // namespace kolsky
