#include "tests/generators/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky::testing {

namespace {

constexpr std::array<std::pair<const char*, NoiseColour>, 4> kNames{
    {{"white", NoiseColour::white},
     {"coloured", NoiseColour::coloured},
     {"pink", NoiseColour::pink},
     {"measured", NoiseColour::measured}}};

// First-order parts of pink noise, each of the white part's variance.
constexpr std::array kPinkTimes_s{2e-6, 8e-6, 32e-6, 128e-6, 512e-6, 2e-3};

// Of coloured noise's first-order part.
constexpr double kShortest_s = 30e-6;
constexpr double kLongest_s = 300e-6;

// First-order noise of unit variance.
std::vector<double> slow(double time_s, double period_s, std::size_t samples,
                         std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double keep = std::exp(-period_s / time_s);
  const double fresh = std::sqrt(1.0 - keep * keep);
  std::vector<double> out(samples);
  double value = normal(random);
  for (double& sample : out) {
    value = keep * value + fresh * normal(random);
    sample = value;
  }
  return out;
}

void add(std::vector<double>& sum, const std::vector<double>& part) {
  for (std::size_t n = 0; n < sum.size(); ++n) {
    sum[n] += part[n];
  }
}

void scale_to(std::vector<double>& values, double rms) {
  double power = 0.0;
  for (const double value : values) {
    power += value * value;
  }
  const double factor =
      power > 0.0 ? rms * std::sqrt(static_cast<double>(values.size()) / power) : 0.0;
  for (double& value : values) {
    value *= factor;
  }
}

// A stretch of the record from a random place on; walked forwards and backwards where it is short,
// so that no jump is added.
std::vector<double> stretch(const std::vector<double>& record, std::size_t samples,
                            std::mt19937_64& random) {
  std::vector<double> out(samples);
  std::uniform_int_distribution<std::size_t> start(0, record.size() - 1);
  const std::size_t round = 2 * record.size() - 2;
  std::size_t place = start(random);
  for (double& value : out) {
    value = record[place < record.size() ? place : round - place];
    place = (place + 1) % round;
  }
  return out;
}

}  // namespace

std::string name_of(NoiseColour colour) {
  for (const auto& [name, other] : kNames) {
    if (other == colour) {
      return name;
    }
  }
  return "";
}

NoiseColour colour_named(const std::string& name) {
  for (const auto& [known, colour] : kNames) {
    if (name == known) {
      return colour;
    }
  }
  throw InputError("--noise-colour", "\"" + name + "\" is no colour of noise",
                   "write white, coloured, pink or measured");
}

std::vector<double> noise(NoiseColour colour, double rms, double period_s, std::size_t samples,
                          std::mt19937_64& random, const std::vector<double>& measured) {
  std::normal_distribution<double> normal;
  std::vector<double> out(samples);
  for (double& value : out) {
    value = normal(random);
  }
  if (colour == NoiseColour::coloured) {
    std::uniform_real_distribution<double> log_time(std::log(kShortest_s), std::log(kLongest_s));
    add(out, slow(std::exp(log_time(random)), period_s, samples, random));
    for (double& value : out) {
      value *= std::sqrt(0.5);
    }
  } else if (colour == NoiseColour::pink) {
    for (const double time_s : kPinkTimes_s) {
      add(out, slow(time_s, period_s, samples, random));
    }
    for (double& value : out) {
      value /= std::sqrt(1.0 + static_cast<double>(kPinkTimes_s.size()));
    }
  } else if (colour == NoiseColour::measured && measured.size() > 8) {
    out = stretch(measured, samples, random);
    scale_to(out, rms);
    return out;
  }
  for (double& value : out) {
    value *= rms;
  }
  return out;
}

std::vector<double> covariance_of(NoiseColour colour, double rms, double period_s,
                                  std::size_t samples) {
  std::vector<double> times_s;
  double slow_part = 0.0;
  if (colour == NoiseColour::coloured) {
    constexpr int kTimes = 64;
    for (int i = 0; i < kTimes; ++i) {
      times_s.push_back(kShortest_s * std::pow(kLongest_s / kShortest_s, (i + 0.5) / kTimes));
    }
    slow_part = 0.5 * rms * rms / kTimes;
  } else if (colour == NoiseColour::pink) {
    times_s.assign(kPinkTimes_s.begin(), kPinkTimes_s.end());
    slow_part = rms * rms / (1.0 + static_cast<double>(kPinkTimes_s.size()));
  }
  std::vector<double> covariance(samples, 0.0);
  covariance[0] = rms * rms - slow_part * static_cast<double>(times_s.size());
  for (std::size_t n = 0; n < samples; ++n) {
    for (const double time_s : times_s) {
      covariance[n] += slow_part * std::exp(-static_cast<double>(n) * period_s / time_s);
    }
  }
  return covariance;
}

}  // namespace kolsky::testing
