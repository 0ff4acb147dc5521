#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "drivers/digitiser/digitiser.hpp"

namespace kolsky {

/// A digitiser that delivers, read by read, what a test writes down.
class ScriptedDigitiser final : public Digitiser {
 public:
  struct Step {
    ReadStatus status = ReadStatus::samples;
    std::size_t samples = 0;
    Missing missing{};
    bool starts_capture = false;
    std::optional<TriggerEvent> mark{};
  };

  static constexpr std::size_t kBlock = 256;
  static constexpr std::size_t kChannels = 2;

  ScriptedDigitiser();

  /// A shot: both channels rise at `tick` and stay up for 150 samples.
  void add_pulse(Tick tick) { pulses_.push_back(tick); }
  /// Appends blocks up to `samples` in all.
  void deliver(std::size_t samples);
  void add(const Step& step) { steps_.push_back(step); }
  /// The step with this index carries a mark.
  void mark_block(std::size_t step, const TriggerEvent& mark) { steps_[step].mark = mark; }
  /// More blocks after the script was read to its end; from another thread than the reader's.
  void append_live(std::size_t samples) { live_.fetch_add(samples); }
  /// A replay: after the script comes the end.
  void end_after_script() { info_.ends = true; }
  void refuse_reconnections(int times) { refusals_ = times; }
  void change_scale_on_reconnect() { rescale_ = true; }

  /// The code of a channel at a tick: noise about an offset, and the pulses.
  [[nodiscard]] std::int16_t code(std::size_t channel, Tick tick) const;
  /// All steps of the script have been read.
  [[nodiscard]] bool script_done() const { return done_.load(); }

  [[nodiscard]] const StreamInfo& info() const override { return info_; }
  void start() override {}
  ReadStatus read(Block& block) override;
  void cancel() override { cancelled_.store(true); }
  bool reconnect() override;
  void fire() override {}

 private:
  ReadStatus give(const Step& step, Block& block);

  StreamInfo info_;
  std::vector<Step> steps_;
  std::vector<Tick> pulses_;
  std::size_t next_ = 0;
  Tick tick_ = 0;
  int refusals_ = 0;
  bool rescale_ = false;
  std::vector<std::vector<std::int16_t>> codes_;
  std::atomic<std::size_t> live_{0};
  std::atomic<bool> cancelled_{false};
  std::atomic<bool> done_{false};
};

/// How often the thread that reads a ScriptedDigitiser has allocated since its second read.
[[nodiscard]] std::uint64_t allocations_while_reading();

}  // namespace kolsky
