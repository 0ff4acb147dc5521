#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace kolsky {

/// The few things used last: benches that are reduced in turn find what was made for them.
template <typename Thing>
class Recent {
 public:
  static constexpr std::size_t kMost = 4;

  /// The one that fits, else a new one in place of that which was not used for longest.
  /// @param fits  of a thing: whether it will do
  /// @param make  gives a std::unique_ptr<Thing>
  template <typename Fits, typename Make>
  [[nodiscard]] Thing& get(const Fits& fits, const Make& make) {
    auto found = std::find_if(things_.begin(), things_.end(),
                              [&](const auto& thing) { return fits(*thing); });
    if (found == things_.end()) {
      if (things_.size() == kMost) {
        things_.pop_back();
      }
      things_.push_back(make());
      ++made_;
      found = things_.end() - 1;
    }
    std::rotate(things_.begin(), found, found + 1);
    return *things_.front();
  }

  [[nodiscard]] std::size_t made() const { return made_; }

 private:
  std::vector<std::unique_ptr<Thing>> things_;  ///< used last first
  std::size_t made_ = 0;
};

}  // namespace kolsky
