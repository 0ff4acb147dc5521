// Prints docs/accuracy.md from live computation, or checks the committed file against it:
//   accuracy [--check docs/accuracy.md]
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "tests/accuracy/table.hpp"

namespace {

using namespace kolsky::accuracy;

constexpr const char* kHead =
    "# How accurate the results are\n\n"
    "Written by `accuracy` (`tests/accuracy`) from live computation; CTest's `accuracy` computes "
    "it "
    "again and holds this file\nagainst it: words must be the same, numbers within one of their "
    "last "
    "digit or 2 %. References are solvers and\ntables that share no code with what is tested.\n\n";

const std::vector<Part> kParts{elastic_waves,
                               viscoelastic_waves,
                               identified_bars,
                               identified_solid_bars,
                               identified_compliances,
                               identified_specimens,
                               identified_specimen_compliances,
                               separated_waves,
                               reduced_shots,
                               rubber_equilibrium,
                               impacts};

/// Parts of a page by their headings.
std::vector<std::string> split(const std::string& page) {
  std::vector<std::string> parts;
  std::size_t from = page.find("\n## ");
  while (from != std::string::npos) {
    const std::size_t to = page.find("\n## ", from + 1);
    parts.push_back(page.substr(from + 1, to == std::string::npos ? to : to - from));
    from = to;
  }
  return parts;
}

struct Number {
  double value = 0.0;
  double unit = 0.0;  ///< of the last digit
  std::size_t length = 0;
};

Number number_at(const std::string& text, std::size_t place) {
  char* end = nullptr;
  Number number;
  number.value = std::strtod(text.c_str() + place, &end);
  number.length = static_cast<std::size_t>(end - (text.c_str() + place));
  const std::string digits = text.substr(place, number.length);
  const std::size_t exponent = digits.find_first_of("eE");
  const std::string mantissa = digits.substr(0, exponent);
  const std::size_t point = mantissa.find('.');
  const double decimals =
      point == std::string::npos ? 0.0 : static_cast<double>(mantissa.size() - point - 1);
  const double power =
      exponent == std::string::npos ? 0.0 : std::strtod(digits.c_str() + exponent + 1, nullptr);
  number.unit = std::pow(10.0, power - decimals);
  return number;
}

/// Alike to the last digit written, or to what another machine's last bits may do to an error.
bool close(const Number& a, const Number& b) {
  constexpr double kRounding = 1.01;
  constexpr double kAlike = 0.02;
  const double larger = std::max(std::abs(a.value), std::abs(b.value));
  return std::abs(a.value - b.value) <=
         std::max({kRounding * a.unit, kRounding * b.unit, kAlike * larger});
}

bool begins_number(const std::string& text, std::size_t i) {
  const bool signed_digit = (text[i] == '-' || text[i] == '+') && i + 1 < text.size() &&
                            std::isdigit(static_cast<unsigned char>(text[i + 1])) != 0;
  return signed_digit || std::isdigit(static_cast<unsigned char>(text[i])) != 0;
}

bool same(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (begins_number(a, i) && begins_number(b, j)) {
      const Number one = number_at(a, i);
      const Number other = number_at(b, j);
      if (!close(one, other)) {
        return false;
      }
      i += one.length;
      j += other.length;
    } else if (a[i++] != b[j++]) {
      return false;
    }
  }
  return i == a.size() && j == b.size();
}

int check(const std::string& path) {
  std::ifstream file(path);
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  const std::vector<std::string> committed = split(page);
  if (committed.size() != kParts.size()) {
    std::cerr << path << " holds " << committed.size() << " parts, " << kParts.size()
              << " are computed: write it anew\n";
    return 1;
  }
  int wrong = 0;
  for (std::size_t p = 0; p < kParts.size(); ++p) {
    const auto section = kParts[p]();
    if (!section) {
      std::cerr << "left out, its data are not beside the project: "
                << committed[p].substr(0, committed[p].find('\n')) << "\n";
      continue;
    }
    std::istringstream computed(markdown(*section));
    std::istringstream filed(committed[p]);
    std::string one;
    std::string other;
    while (std::getline(computed, one)) {
      other.clear();
      std::getline(filed, other);
      if (!same(one, other)) {
        std::cerr << "computed: " << one << "\nfiled:    " << other << "\n";
        ++wrong;
      }
    }
    while (std::getline(filed, other)) {
      if (!other.empty()) {
        std::cerr << "filed, but not computed: " << other << "\n";
        ++wrong;
      }
    }
  }
  return wrong == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 2 && words[0] == "--check") {
    return check(words[1]);
  }
  if (!words.empty()) {
    std::cerr << "usage: accuracy [--check docs/accuracy.md]\n";
    return 2;
  }
  std::cout << kHead;
  for (const Part part : kParts) {
    if (const auto section = part()) {
      std::cout << markdown(*section);
    }
  }
  return 0;
}
