#include <filesystem>

#include "drivers/digitiser/open.hpp"
#include "drivers/files/captures/capture.hpp"
#include "tests/conformance/pattern_capture.hpp"
#include "tests/conformance/rig.hpp"
#include "tests/scratch_folder.hpp"

namespace kolsky {
namespace {

constexpr Tick kHoleAt = 30'000;
constexpr Tick kHole = 777;

class ReplayRig final : public Rig {
 public:
  explicit ReplayRig(int captures) : captures_(captures) {}

  std::unique_ptr<Digitiser> open(double speed, Tick samples) override {
    write(samples, false);
    return replay(speed);
  }

  std::unique_ptr<Digitiser> open_with_hole() override {
    write(kSamples, true);
    return replay(0.0);
  }
  [[nodiscard]] Tick hole_samples() const override { return kHole; }
  [[nodiscard]] bool announces_holes() const override { return false; }

  /// A capture that goes away while another one is being played: it is there when the replay is
  /// opened.
  std::unique_ptr<Digitiser> open_to_break() override {
    write_capture(pattern_shot(0, 30'000), file(0));
    write_capture(pattern_shot(30'000, 60'000), file(1));
    return replay(0.0);
  }
  void break_off() override { std::filesystem::rename(file(1), away()); }
  void mend() override { std::filesystem::rename(away(), file(1)); }

  [[nodiscard]] bool simulated() const override { return false; }

 private:
  void write(Tick samples, bool with_hole) {
    const Tick each = samples / captures_;
    for (int i = 0; i < captures_; ++i) {
      Shot shot = pattern_shot(i * each, static_cast<std::size_t>(each));
      if (with_hole && i == 0) {
        make_gap(shot, shot.first_tick + kHoleAt, kHole);
      }
      write_capture(shot, file(i));
    }
  }

  std::unique_ptr<Digitiser> replay(double speed) {
    DigitiserOptions options;
    options.channel_count = kChannels;
    options.sampling_frequency_Hz = kRate_Hz;
    options.block_samples = kBlockSamples;
    options.units = {"V", "V"};
    options.replay_speed = speed;
    const bool one = captures_ == 1 && !std::filesystem::exists(file(1));
    return open_digitiser("replay:" + (one ? file(0) : folder_.path()).string(), options);
  }

  [[nodiscard]] std::filesystem::path file(int i) const {
    return folder_.path() / ("capture-" + std::to_string(i) + ".h5");
  }
  [[nodiscard]] std::filesystem::path away() const { return folder_.path() / "away"; }

  int captures_;
  testing::ScratchFolder folder_;
};

}  // namespace

std::unique_ptr<Rig> make_capture_rig() {
  return std::make_unique<ReplayRig>(1);
}

std::unique_ptr<Rig> make_folder_rig() {
  return std::make_unique<ReplayRig>(4);
}

}  // namespace kolsky
