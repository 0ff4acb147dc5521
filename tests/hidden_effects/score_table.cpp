#include "tests/hidden_effects/score_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace kolsky::scoring {

namespace {

using Selector = std::function<bool(const Verdict&)>;

std::vector<double> values(const std::vector<Verdict>& verdicts, const Selector& select,
                           const std::function<double(const Verdict&)>& value) {
  std::vector<double> out;
  for (const Verdict& verdict : verdicts) {
    if (select(verdict)) {
      out.push_back(value(verdict));
    }
  }
  return out;
}

double mean(const std::vector<double>& numbers) {
  double sum = 0.0;
  for (const double number : numbers) {
    sum += number;
  }
  return sum / static_cast<double>(numbers.size());
}

double quantile(std::vector<double> numbers, double share) {
  std::ranges::sort(numbers);
  const auto place = static_cast<std::size_t>(share * static_cast<double>(numbers.size() - 1));
  return numbers[place];
}

enum class Sense { at_least, at_most };

Measure measure(const std::string& name, const std::vector<double>& numbers, double wanted,
                Sense sense, double (*summary)(const std::vector<double>&) = mean) {
  Measure made{name,
               fmt::format("{} {:g}", sense == Sense::at_least ? ">=" : "<=", wanted),
               {},
               numbers.size(),
               false};
  if (!numbers.empty()) {
    made.got = summary(numbers);
    made.met = sense == Sense::at_least ? *made.got >= wanted : *made.got <= wanted;
  }
  return made;
}

Selector of_kind(CaseKind kind) {
  return [kind](const Verdict& verdict) { return verdict.kind == kind; };
}

// Largest distance of the p-values' distribution from the uniform one, as a p-value itself.
double uniformity(std::vector<double> p) {
  std::ranges::sort(p);
  const auto n = static_cast<double>(p.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto at = static_cast<double>(i);
    distance = std::max({distance, p[i] - at / n, (at + 1.0) / n - p[i]});
  }
  const double x = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * distance;
  double sum = 0.0;
  for (int k = 1; k < 50; ++k) {
    sum += (k % 2 == 1 ? 2.0 : -2.0) * std::exp(-2.0 * k * k * x * x);
  }
  return std::clamp(sum, 0.0, 1.0);
}

/// Of all cases together: whether what is stated lies within its 95 % interval of the truth.
std::vector<double> pooled(const std::vector<Verdict>& verdicts,
                           std::vector<double> Verdict::*distances) {
  std::vector<double> inside;
  for (const Verdict& verdict : verdicts) {
    for (const double distance : verdict.*distances) {
      inside.push_back(std::abs(distance) < 1.96 ? 1.0 : 0.0);
    }
  }
  return inside;
}

Measure uniformity_measure(const std::vector<Verdict>& verdicts) {
  std::vector<double> p = values(
      verdicts, [](const Verdict& v) { return v.null_p.has_value(); },
      [](const Verdict& v) { return *v.null_p; });
  Measure made{"p-values on nulls uniform (KS p)", ">= 0.01", {}, p.size(), false};
  if (p.size() >= 20) {
    made.got = uniformity(p);
    made.met = *made.got >= 0.01;
  }
  return made;
}

Measure localisation_measure(const std::vector<Verdict>& verdicts) {
  Localisation together;
  std::size_t cases = 0;
  for (const Verdict& verdict : verdicts) {
    if (verdict.places) {
      together += *verdict.places;
      ++cases;
    }
  }
  Measure made{"localisation of the failure, F1 over places", ">= 0.9", {}, cases, false};
  if (cases > 0) {
    made.got = together.all.f1();
    made.met = *made.got >= 0.9;
  }
  return made;
}

std::string said(const Verdict& verdict) {
  if (verdict.named.empty()) {
    return verdict.answered;
  }
  std::string text;
  for (const auto& members : verdict.sets) {
    text += text.empty() ? "" : " + ";
    std::string one;
    for (const std::string& member : members) {
      const std::string family = member.substr(0, member.find(':'));
      if (one.find(family) == std::string::npos) {
        one += (one.empty() ? "" : "|") + family;
      }
    }
    text += one;
  }
  return text;
}

std::string hidden(const Verdict& verdict) {
  std::string text;
  for (const std::string& name : verdict.truth) {
    text += (text.empty() ? "" : " + ") + name.substr(0, name.find(':'));
  }
  return text.empty() ? "(nothing)" : text;
}

}  // namespace

std::vector<Measure> measures(const std::vector<Verdict>& verdicts) {
  const auto single = of_kind(CaseKind::single);
  const auto two = of_kind(CaseKind::two);
  const auto strange = of_kind(CaseKind::withheld);
  const auto found = [](const Verdict& v) { return v.found >= 1 ? 1.0 : 0.0; };
  const auto named_any = [](const Verdict& v) { return v.named.empty() ? 0.0 : 1.0; };
  const auto tied = of_kind(CaseKind::tied);
  const auto named_single = [&](const Verdict& v) {
    return (single(v) || tied(v)) && !v.named.empty();
  };
  const auto closed = [&](const Verdict& v) {
    return single(v) && v.found == 1 && v.closure && v.multiples.front() >= 2.0;
  };
  const std::vector<double> closures =
      values(verdicts, closed, [](const Verdict& v) { return *v.closure; });
  return {
      measure("false claim where nothing is hidden",
              values(verdicts, of_kind(CaseKind::null), named_any), 0.01, Sense::at_most),
      measure("right class, single effect", values(verdicts, single, found), 0.97, Sense::at_least),
      measure("exact name, single effect",
              values(verdicts, single, [](const Verdict& v) { return v.exact ? 1.0 : 0.0; }), 0.95,
              Sense::at_least),
      measure("right class, effect in a tie", values(verdicts, tied, found), 0.97, Sense::at_least),
      measure("reported set holds the truth", values(verdicts, named_single, found), 0.99,
              Sense::at_least),
      measure("mean size of the set",
              values(verdicts, named_single, [](const Verdict& v) { return v.set_size; }), 2.0,
              Sense::at_most),
      measure("both of two",
              values(verdicts, two, [](const Verdict& v) { return v.found == 2 ? 1.0 : 0.0; }),
              0.85, Sense::at_least),
      measure("at least one of two", values(verdicts, two, found), 0.97, Sense::at_least),
      measure("absorbed effect: nothing false claimed",
              values(verdicts, of_kind(CaseKind::absorbed),
                     [](const Verdict& v) { return v.named.empty() || v.found == 1 ? 1.0 : 0.0; }),
              0.99, Sense::at_least),
      measure("withheld effect called unknown",
              values(verdicts, strange,
                     [](const Verdict& v) { return v.answered == "unknown" ? 1.0 : 0.0; }),
              0.90, Sense::at_least),
      measure("withheld effect falsely named", values(verdicts, strange, named_any), 0.05,
              Sense::at_most),
      measure("held-out misfit closed, median", closures, 0.95, Sense::at_least,
              [](const std::vector<double>& c) { return quantile(c, 0.5); }),
      measure("held-out misfit closed, 5th percentile", closures, 0.85, Sense::at_least,
              [](const std::vector<double>& c) { return quantile(c, 0.05); }),
      measure("moduli inside 95 % after adding", pooled(verdicts, &Verdict::moduli_in_sd), 0.93,
              Sense::at_least),
      measure("stress-strain curve inside 95 %", pooled(verdicts, &Verdict::curve_in_sd), 0.93,
              Sense::at_least),
      measure("95 % interval of the strength holds the truth",
              values(
                  verdicts, [](const Verdict& v) { return v.strength_in_sd.has_value(); },
                  [](const Verdict& v) { return std::abs(*v.strength_in_sd) < 1.96 ? 1.0 : 0.0; }),
              0.93, Sense::at_least),
      measure("tie broken by the experiment proposed",
              values(
                  verdicts, [](const Verdict& v) { return v.tie_broken.has_value(); },
                  [](const Verdict& v) { return *v.tie_broken ? 1.0 : 0.0; }),
              0.90, Sense::at_least),
      localisation_measure(verdicts),
      uniformity_measure(verdicts),
      measure("ended without failure or timeout",
              values(
                  verdicts, [](const Verdict&) { return true; },
                  [](const Verdict& v) {
                    return v.answered == "failed" || v.answered == "timeout" ? 0.0 : 1.0;
                  }),
              1.0, Sense::at_least)};
}

std::string table_text(const std::vector<Measure>& measures) {
  std::string text = fmt::format("{:<48}{:>10}{:>10}{:>8}\n", "measure", "wanted", "got", "n");
  for (const Measure& one : measures) {
    const std::string got = one.got ? fmt::format("{:.3f}", *one.got) : "-";
    text += fmt::format("{:<48}{:>10}{:>10}{:>8}{}\n", one.name, one.wanted, got, one.cases,
                        one.got && !one.met ? "  SHORT" : "");
  }
  return text;
}

std::string confusion_text(const std::vector<Verdict>& verdicts) {
  std::map<std::string, std::map<std::string, int>> rows;
  for (const Verdict& verdict : verdicts) {
    ++rows[hidden(verdict)][said(verdict)];
  }
  std::string text;
  for (const auto& [truth, answers] : rows) {
    std::vector<std::pair<int, std::string>> sorted;
    for (const auto& [answer, count] : answers) {
      sorted.emplace_back(count, answer);
    }
    std::ranges::sort(sorted, std::greater{});
    text += fmt::format("{:<44}", truth);
    for (const auto& [count, answer] : sorted) {
      text += fmt::format(" {} x {};", count, answer);
    }
    text += "\n";
  }
  return text;
}

std::map<std::string, Localisation> places_by_effect(const std::vector<Verdict>& verdicts) {
  std::map<std::string, Localisation> rows;
  for (const Verdict& verdict : verdicts) {
    if (verdict.places) {
      rows[hidden(verdict)] += *verdict.places;
    }
  }
  return rows;
}

std::string places_text(const std::vector<Verdict>& verdicts) {
  std::string text =
      fmt::format("{:<28}{:>8}{:>8}{:>8}{:>11}{:>8}{:>7}{:>14}{:>8}\n", "", "failing", "marked",
                  "both", "precision", "recall", "F1", "F1, touched", "ideal");
  const auto row = [](const std::string& name, const Localisation& own) {
    return fmt::format("{:<28}{:>8}{:>8}{:>8}{:>11.2f}{:>8.2f}{:>7.2f}{:>14.2f}{:>8.2f}\n", name,
                       own.all.failing, own.all.marked, own.all.both, own.all.precision(),
                       own.all.recall(), own.all.f1(), own.touched.f1(), own.ideal_f1());
  };
  Localisation together;
  for (const auto& [effect, own] : places_by_effect(verdicts)) {
    text += row(effect, own);
    together += own;
  }
  return text + row("all", together);
}

std::string safeguards_text(const BySafeguard& verdicts) {
  constexpr std::array kColumns{std::pair{"false claims", "false claim where nothing is hidden"},
                                std::pair{"right class", "right class, single effect"},
                                std::pair{"truth in set", "reported set holds the truth"},
                                std::pair{"both of two", "both of two"},
                                std::pair{"withheld named", "withheld effect falsely named"}};
  std::string text = fmt::format("{:<18}", "without");
  for (const auto& [title, name] : kColumns) {
    text += fmt::format("{:>16}", title);
  }
  for (const auto& [safeguard, own] : verdicts) {
    text += fmt::format("\n{:<18}", safeguard == "all" ? "(all there)" : safeguard);
    const std::vector<Measure> table = measures(own);
    for (const auto& [title, name] : kColumns) {
      const auto found = std::ranges::find(table, name, &Measure::name);
      const std::size_t cases = found->cases;
      text += fmt::format(
          "{:>16}",
          found->got ? fmt::format("{:.0f} of {}", *found->got * static_cast<double>(cases), cases)
                     : "-");
    }
  }
  return text + "\n";
}

std::string power_text(const std::vector<Verdict>& verdicts) {
  std::map<std::string, std::map<double, std::pair<int, int>>> rows;
  for (const Verdict& verdict : verdicts) {
    if (verdict.kind == CaseKind::single) {
      const double multiple = std::exp2(std::floor(std::log2(verdict.multiples.front()) + 1e-6));
      auto& [right, all] = rows[hidden(verdict)][std::min(multiple, 8.0)];
      right += verdict.found;
      ++all;
    }
  }
  std::string text;
  for (const auto& [effect, sizes] : rows) {
    text += fmt::format("{:<28}", effect);
    for (const auto& [multiple, count] : sizes) {
      text += fmt::format("  {:g}x {}/{}", multiple, count.first, count.second);
    }
    text += "\n";
  }
  return text;
}

}  // namespace kolsky::scoring
