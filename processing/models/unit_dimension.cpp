#include "processing/models/unit_dimension.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

struct NamedUnit {
  std::string_view name;
  Dimension dimension;
};

// kg, m, s, K, A
constexpr std::array kUnits{
    NamedUnit{"-", {}},
    NamedUnit{"1", {}},
    NamedUnit{"strain", {}},
    NamedUnit{"rad", {}},
    NamedUnit{"kg", {{1, 0, 0, 0, 0}}},
    NamedUnit{"m", {{0, 1, 0, 0, 0}}},
    NamedUnit{"s", {{0, 0, 1, 0, 0}}},
    NamedUnit{"K", {{0, 0, 0, 1, 0}}},
    NamedUnit{"A", {{0, 0, 0, 0, 1}}},
    NamedUnit{"Hz", {{0, 0, -1, 0, 0}}},
    NamedUnit{"N", {{1, 1, -2, 0, 0}}},
    NamedUnit{"Pa", {{1, -1, -2, 0, 0}}},
    NamedUnit{"J", {{1, 2, -2, 0, 0}}},
    NamedUnit{"W", {{1, 2, -3, 0, 0}}},
    NamedUnit{"V", {{1, 2, -3, 0, -1}}},
    NamedUnit{"ohm", {{1, 2, -3, 0, -2}}},
};

/// Reads products and quotients of units with whole powers, from left to right; a quotient takes
/// what follows it up to the next sign, or a bracket.
class UnitReader {
 public:
  explicit UnitReader(const std::string& text) : text_(text) {}

  Dimension read() {
    const Dimension dimension = product(0);
    if (at_ < text_.size()) {
      refuse();
    }
    return dimension;
  }

 private:
  static constexpr int kDeepest = 4;

  [[noreturn]] void refuse() const {
    throw InputError("\"" + text_ + "\"", "is no unit that is known here",
                     "write it in SI without prefixes, as 1/(Pa s), m2/s or -");
  }

  void skip() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '*')) {
      ++at_;
    }
  }

  Dimension product(int depth) {
    Dimension all = factor(depth);
    for (skip(); at_ < text_.size() && text_[at_] != ')'; skip()) {
      const bool over = text_[at_] == '/';
      if (over) {
        ++at_;
        skip();
      }
      all = all.times(factor(depth), over ? -1.0 : 1.0);
    }
    return all;
  }

  Dimension factor(int depth) {
    skip();
    if (at_ < text_.size() && text_[at_] == '(') {
      if (depth == kDeepest) {
        refuse();
      }
      ++at_;
      const Dimension inner = product(depth + 1);
      if (at_ >= text_.size()) {
        refuse();
      }
      ++at_;
      return inner;
    }
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    std::size_t end = at_;
    while (end < text_.size() && letter(text_[end])) {
      ++end;
    }
    if (end == at_ && at_ < text_.size() && (text_[at_] == '1' || text_[at_] == '-')) {
      ++end;
    }
    const std::string name = text_.substr(at_, end - at_);
    const auto found = std::find_if(kUnits.begin(), kUnits.end(),
                                    [&](const NamedUnit& unit) { return unit.name == name; });
    if (found == kUnits.end()) {
      refuse();
    }
    at_ = end;
    return Dimension{}.times(found->dimension, power());
  }

  double power() {
    if (at_ < text_.size() && text_[at_] == '^') {
      ++at_;
    }
    double sign = 1.0;
    if (at_ + 1 < text_.size() && text_[at_] == '-' && text_[at_ + 1] >= '1' &&
        text_[at_ + 1] <= '9') {
      sign = -1.0;
      ++at_;
    }
    if (at_ < text_.size() && text_[at_] >= '1' && text_[at_] <= '9') {
      return sign * (text_[at_++] - '0');
    }
    return 1.0;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

}  // namespace

bool Dimension::none() const {
  return same({});
}

bool Dimension::same(const Dimension& other) const {
  constexpr double kRounding = 1e-9;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (!(std::abs(of[i] - other.of[i]) < kRounding)) {
      return false;
    }
  }
  return true;
}

Dimension Dimension::times(const Dimension& other, double power) const {
  Dimension product;
  for (std::size_t i = 0; i < of.size(); ++i) {
    product.of[i] = of[i] + power * other.of[i];
  }
  return product;
}

std::string Dimension::text() const {
  if (none()) {
    return "no unit";
  }
  constexpr std::array<const char*, 5> kNames{"kg", "m", "s", "K", "A"};
  std::string list;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (of[i] != 0.0) {
      list += (list.empty() ? "" : " ") + std::string(kNames[i]);
      list += of[i] == 1.0 ? "" : fmt::format("^{:g}", of[i]);
    }
  }
  return list;
}

Dimension dimension_of(const std::string& unit) {
  return UnitReader(unit).read();
}

}  // namespace kolsky
