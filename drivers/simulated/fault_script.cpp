#include "drivers/simulated/fault_script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <istream>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>

#include "drivers/simulated/number_text.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

enum class Argument { none, samples, duration, maybe_duration };

struct Kind {
  const char* name;
  FaultKind kind;
  Argument argument;
};

constexpr std::array kKinds{
    Kind{"short", FaultKind::short_block, Argument::samples},
    Kind{"late", FaultKind::late_block, Argument::duration},
    Kind{"timeout", FaultKind::timeout, Argument::none},
    Kind{"hang", FaultKind::hang, Argument::maybe_duration},
    Kind{"drop", FaultKind::drop, Argument::duration},
    Kind{"lose", FaultKind::lose, Argument::samples},
    Kind{"extra-channel", FaultKind::extra_channel, Argument::none},
    Kind{"overflow", FaultKind::overflow, Argument::none},
    Kind{"clip", FaultKind::clip, Argument::samples},
};

constexpr const char* kForm = "write `shot N at SAMPLE KIND` or `time DURATION KIND`";
constexpr std::int64_t kMostSamples = 1'000'000'000;
constexpr double kLongest_s = 1e6;

/// The words of a line, taken one by one; what is wrong is told with the line's place.
class Line {
 public:
  Line(const std::string& text, std::string place) : words_(text), place_(std::move(place)) {}

  std::string next() {
    std::string word;
    words_ >> word;
    return word;
  }

  [[noreturn]] void refuse(const std::string& what, const std::string& mend) const {
    throw InputError(place_, what, mend);
  }

  std::int64_t whole_number(const std::string& of, std::int64_t least) {
    const std::string word = next();
    const auto number = parse_number<std::int64_t>(word);
    if (!number || *number < least || *number > kMostSamples) {
      refuse("'" + word + "' is not a number of " + of, "give a whole number from " +
                                                            std::to_string(least) + " to " +
                                                            std::to_string(kMostSamples));
    }
    return *number;
  }

  double duration_s(const std::string& word) const {
    static constexpr std::array<std::pair<std::string_view, double>, 3> kUnits{
        {{"ms", 1e-3}, {"us", 1e-6}, {"s", 1.0}}};
    for (const auto& [unit, seconds] : kUnits) {
      if (!word.ends_with(unit)) {
        continue;
      }
      const auto number =
          parse_number<double>(std::string_view(word).substr(0, word.size() - unit.size()));
      if (number && *number >= 0.0 && *number * seconds <= kLongest_s) {
        return *number * seconds;
      }
      break;
    }
    refuse("'" + word + "' is not a duration",
           "give a number with its unit right behind it: 2.5s, 20ms, 300us");
  }

 private:
  std::istringstream words_;
  std::string place_;
};

void read_moment(Line& line, Fault& fault) {
  const std::string when = line.next();
  if (when == "shot") {
    fault.shot = line.whole_number("shots", 1);
    if (const std::string at = line.next(); at != "at") {
      line.refuse("'" + at + "' stands where `at` belongs", kForm);
    }
    fault.at_sample = line.whole_number("samples", 0);
  } else if (when == "time") {
    fault.time_s = line.duration_s(line.next());
  } else {
    line.refuse("'" + when + "' is no moment", kForm);
  }
}

std::string known_kinds() {
  std::string names;
  for (const Kind& kind : kKinds) {
    names += (names.empty() ? std::string() : std::string(", ")) + kind.name;
  }
  return names;
}

void read_kind(Line& line, Fault& fault) {
  const std::string name = line.next();
  const auto* const kind =
      std::find_if(kKinds.begin(), kKinds.end(), [&name](const Kind& k) { return name == k.name; });
  if (kind == kKinds.end()) {
    line.refuse("'" + name + "' is no kind of fault", "give one of " + known_kinds());
  }
  fault.kind = kind->kind;
  switch (kind->argument) {
    case Argument::none:
      break;
    case Argument::samples:
      fault.samples = line.whole_number("samples", 1);
      break;
    case Argument::duration:
      fault.duration_s = line.duration_s(line.next());
      break;
    case Argument::maybe_duration:
      if (const std::string word = line.next(); !word.empty()) {
        fault.duration_s = line.duration_s(word);
      }
      break;
  }
  if (const std::string more = line.next(); !more.empty()) {
    line.refuse("'" + more + "' is one word too many", "end the line after `" + name + "`'s own");
  }
}

}  // namespace

const char* fault_name(FaultKind kind) {
  return std::find_if(kKinds.begin(), kKinds.end(),
                      [kind](const Kind& k) { return k.kind == kind; })
      ->name;
}

std::vector<Fault> parse_fault_script(std::istream& script, const std::string& name) {
  std::vector<Fault> faults;
  std::string text;
  for (int number = 1; std::getline(script, text); ++number) {
    text.resize(std::min(text.find('#'), text.size()));
    if (text.find_first_not_of(" \t\r") == std::string::npos) {
      continue;
    }
    Line line(text, name + ":" + std::to_string(number));
    Fault fault;
    read_moment(line, fault);
    read_kind(line, fault);
    faults.push_back(fault);
  }
  return faults;
}

FaultQueue::FaultQueue(const std::vector<Fault>& faults, SampleRate rate) {
  for (const Fault& fault : faults) {
    if (fault.shot > 0) {
      of_shots_.push_back(fault);
    } else {
      insert({static_cast<Tick>(std::llround(fault.time_s * rate.Hz())), fault});
    }
  }
}

void FaultQueue::insert(Due due) {
  const auto place =
      std::upper_bound(due_.begin(), due_.end(), due.tick,
                       [](Tick tick, const Due& other) { return tick < other.tick; });
  due_.insert(place, due);
}

void FaultQueue::shot_fired(std::int64_t shot, Tick tick) {
  std::erase_if(of_shots_, [&](const Fault& fault) {
    if (fault.shot != shot) {
      return false;
    }
    insert({tick + fault.at_sample, fault});
    return true;
  });
}

std::optional<FaultQueue::Due> FaultQueue::take_before(Tick end) {
  if (due_.empty() || due_.front().tick >= end) {
    return std::nullopt;
  }
  const Due first = due_.front();
  due_.erase(due_.begin());
  return first;
}

}  // namespace kolsky
