#include "drivers/files/settings/nearest_name.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace kolsky {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0U);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U);
      row[j] = std::min({replace, last[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    std::swap(before_last, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

namespace {

/// A word that stops short of a name counts as one edit, however much is left out.
std::size_t distance_to(std::string_view word, const std::string& name) {
  const std::size_t distance = edit_distance(word, name);
  return name.starts_with(word) ? std::min<std::size_t>(distance, 1) : distance;
}

}  // namespace

std::string nearest_name(std::string_view word, const std::vector<std::string>& names) {
  // A key is never this long; bounding it bounds the work that a hostile file can ask for.
  constexpr std::size_t kLongest = 256;
  std::string nearest;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& name : names) {
    const std::size_t distance = distance_to(word.substr(0, kLongest), name);
    if (distance < least) {
      least = distance;
      nearest = name;
    }
  }
  return nearest;
}

}  // namespace kolsky
