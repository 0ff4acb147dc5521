#include "clients/cli/reports/waterfall_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/cli/reports/criticism_text.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/reports/share_text.hpp"
#include "clients/figure/layout.hpp"
#include "clients/terminal/plot.hpp"

namespace kolsky::cli {

namespace {

constexpr std::size_t kMostColumns = 110;
constexpr std::size_t kFewestBlocks = 20;
constexpr double kRoomBelowFloor = 1.3;  ///< as a ratio, so that the floor itself has a bar
constexpr int kCurveRows = 12;
constexpr double kRelieved = 1.0;  ///< of chi2; below that it is not worth a word

std::string name_of(const WaterfallStep& step) {
  if (step.effect.empty()) {
    return "first model";
  }
  return (step.removed ? "- " : "+ ") + step.effect;
}

JsonValue describe_numbers(const std::vector<MovedNumber>& numbers) {
  JsonObject object;
  for (const MovedNumber& number : numbers) {
    object.push_back(
        {number.name,
         JsonObject{{"value", number.value}, {"sd", number.sd}, {"unit", number.unit}}});
  }
  return object;
}

JsonValue describe_speeds(const std::vector<SpeedMisfit>& speeds) {
  JsonList list;
  for (const SpeedMisfit& speed : speeds) {
    JsonObject own{{"speed_m_per_s", speed.speed_m_per_s},
                   {"rms_percent_of_peak", speed.rms_percent},
                   {"noise_percent_of_peak", speed.noise_percent}};
    if (speed.restitution_measured > 0.0) {
      own.push_back({"restitution", JsonObject{{"measured", speed.restitution_measured},
                                               {"foretold", speed.restitution_foretold}}});
    }
    list.push_back(std::move(own));
  }
  return list;
}

/// Bars from a little below the floor, one block a step of the logarithm.
class Bars {
 public:
  Bars(const Waterfall& fall, std::size_t blocks, bool colour)
      : blocks_(static_cast<double>(blocks)), colour_(colour) {
    low_ = fall.floor;
    double high = fall.floor;
    for (const WaterfallStep& step : fall.steps) {
      low_ = std::min(low_, step.held_out);
      high = std::max(high, step.held_out);
    }
    low_ /= kRoomBelowFloor;
    span_ = std::log(std::max(high, 1.01 * low_) / low_);
  }

  [[nodiscard]] std::string bar(double left, double before, Ink ink) const {
    const std::size_t solid = columns(left);
    const std::size_t all = std::max(solid, columns(before));
    std::string text;
    for (std::size_t i = 0; i < solid; ++i) {
      text += "█";
    }
    std::string gone;
    for (std::size_t i = solid; i < all; ++i) {
      gone += "░";
    }
    return inked(text, ink, colour_) + inked(gone, Ink::dim, colour_);
  }

 private:
  [[nodiscard]] std::size_t columns(double level) const {
    const double share = std::log(std::max(level, low_) / low_) / span_;
    return static_cast<std::size_t>(std::lround(share * blocks_));
  }

  double low_ = 1.0;
  double span_ = 1.0;
  double blocks_;
  bool colour_;
};

/// Whether shots differ by more than noise, which counts as noise in every level.
bool scattered(const Waterfall& fall) {
  constexpr double kScattered = 1.25;
  return fall.shots > 1 && fall.last_beside_quiet.value_or(1.0) >
                               kScattered * std::max(1.0, fall.steps.back().held_out);
}

std::string noise_of(const Waterfall& fall) {
  return scattered(fall) ? "noise and scatter" : "noise alone";
}

std::string bars_text(const Waterfall& fall, const Terminal& terminal) {
  std::size_t names = std::string("repeats unexplained").size();
  for (const WaterfallStep& step : fall.steps) {
    names = std::max(names, name_of(step).size());
  }
  names = std::max(names, noise_of(fall).size());
  const std::size_t columns =
      std::min(kMostColumns, static_cast<std::size_t>(std::max(40, terminal.columns)));
  const std::size_t used = names + 14;
  const Bars bars(fall, std::max(kFewestBlocks, columns > used ? columns - used : 0),
                  terminal.colour);
  std::string text;
  double before = fall.steps.empty() ? fall.floor : fall.steps.front().held_out;
  for (const WaterfallStep& step : fall.steps) {
    text += fmt::format("  {} {:>9.4g}  {}\n", padded_right(name_of(step), names), step.held_out,
                        bars.bar(step.held_out, before, Ink::first));
    before = step.held_out;
  }
  text += fmt::format("  {} {:>9.4g}  {}\n", padded_right(noise_of(fall), names), fall.floor,
                      bars.bar(fall.floor, fall.floor, Ink::good));
  return text;
}

std::string strengths_text(const WaterfallStep& step) {
  std::string text;
  for (const MovedNumber& number : step.strengths) {
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", number.name,
                        number_text(number.value, number.sd, number.unit));
  }
  return text;
}

/// What the filed numbers' pull has to do with a step; empty where it is nothing to speak of.
std::string pull_text(const Waterfall& fall, const WaterfallStep& step) {
  if (std::abs(step.relief) <= kRelieved) {
    return "";
  }
  return fmt::format("; {}filed numbers pull {:.1f} {}", fall.pull_counts ? "counted in it, " : "",
                     std::abs(step.relief), step.relief > 0.0 ? "less" : "more");
}

std::string drops_text(const Waterfall& fall) {
  std::string text;
  for (const WaterfallStep& step : fall.steps) {
    if (step.effect.empty()) {
      continue;
    }
    const std::string strengths = strengths_text(step);
    text += fmt::format("  {}: {} {:.1f} of chi2 on held-out {}, better in {} of {}{}\n",
                        name_of(step), step.gain >= 0.0 ? "takes off" : "adds", std::abs(step.gain),
                        fall.fold, step.better, fall.folds, pull_text(fall, step));
    text += strengths.empty() ? "" : "      " + strengths + "\n";
  }
  return text;
}

/// Numbers that some model of the lineage fits: what all hold tells nothing.
std::vector<std::size_t> fitted_numbers(const Waterfall& fall) {
  std::vector<std::size_t> list;
  for (std::size_t p = 0; p < fall.steps.front().numbers.size(); ++p) {
    if (std::any_of(fall.steps.begin(), fall.steps.end(), [&](const WaterfallStep& step) {
          return p < step.numbers.size() && step.numbers[p].sd > 0.0;
        })) {
      list.push_back(p);
    }
  }
  return list;
}

std::string value_text(const MovedNumber& number) {
  return number_text(number.value, number.sd, number.unit) + (number.sd > 0.0 ? "" : ", held");
}

std::string percent_text(double percent) {
  constexpr double kWhole = 100.0;
  return std::abs(percent) < kWhole ? fmt::format("{:+.2g} %", percent)
                                    : fmt::format("{:+.0f} %", percent);
}

/// How far a number went since the first model.
std::string moved_text(const Waterfall& fall, std::size_t step, std::size_t number) {
  const auto& first = fall.steps.front().numbers;
  const auto& own = fall.steps[step].numbers;
  if (step == 0 || number >= first.size() || number >= own.size() || first[number].value == 0.0 ||
      own[number].value == first[number].value) {
    return "";
  }
  return percent_text(100.0 * (own[number].value / first[number].value - 1.0));
}

std::vector<std::vector<std::string>> number_rows(const Waterfall& fall) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < fall.steps.size(); ++i) {
    std::vector<std::string> row{name_of(fall.steps[i])};
    for (const std::size_t p : fitted_numbers(fall)) {
      row.push_back(p < fall.steps[i].numbers.size() ? value_text(fall.steps[i].numbers[p]) : "");
      row.push_back(moved_text(fall, i, p));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<std::string> number_header(const Waterfall& fall) {
  std::vector<std::string> header{"model"};
  for (const std::size_t p : fitted_numbers(fall)) {
    std::string name = fall.steps.front().numbers[p].name;
    for (const char* unit : {"_Pa_s", "_Pa"}) {
      if (name.ends_with(unit)) {
        name.resize(name.size() - std::string(unit).size());
        break;
      }
    }
    header.push_back(name);
    header.emplace_back("moved");
  }
  return header;
}

std::string table_text(const std::vector<std::string>& header,
                       const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < header.size(); ++c) {
    widths.push_back(columns_of(header[c]));
    for (const auto& row : rows) {
      widths[c] = std::max(widths[c], c < row.size() ? columns_of(row[c]) : 0);
    }
  }
  const auto line = [&](const std::vector<std::string>& row) {
    std::string text = " ";
    for (std::size_t c = 0; c < row.size(); ++c) {
      text += " " + padded_right(row[c], widths[c]) + " ";
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text + "\n";
  };
  std::string text = line(header);
  for (const auto& row : rows) {
    text += line(row);
  }
  return text;
}

/// Rows of models, a column of every speed, and what noise leaves.
std::vector<std::vector<std::string>> speed_rows(const Waterfall& fall) {
  std::vector<std::vector<std::string>> rows;
  const auto restitutions = [](const SpeedMisfit& speed) {
    return speed.restitution_measured > 0.0
               ? fmt::format("{:+.4f}", speed.restitution_measured - speed.restitution_foretold)
               : std::string();
  };
  for (const WaterfallStep& step : fall.steps) {
    std::vector<std::string> row{name_of(step)};
    for (const SpeedMisfit& speed : step.speeds) {
      row.push_back(fmt::format("{:.2f}", speed.rms_percent));
      row.push_back(restitutions(speed));
    }
    rows.push_back(std::move(row));
  }
  std::vector<std::string> noise{noise_of(fall)};
  for (const SpeedMisfit& speed : fall.steps.back().speeds) {
    noise.push_back(fmt::format("{:.2f}", speed.noise_percent));
    noise.emplace_back();
  }
  rows.push_back(std::move(noise));
  return rows;
}

std::vector<std::string> speed_header(const Waterfall& fall) {
  std::vector<std::string> header{"model"};
  for (const SpeedMisfit& speed : fall.steps.front().speeds) {
    header.push_back(fmt::format("{:.1f} m/s", speed.speed_m_per_s));
    header.emplace_back("restitution");
  }
  return header;
}

constexpr const char* kSpeedWords =
    "Deviation of the mean force from the fitted one, rms in % of the peak, and measured less "
    "foretold restitution:";

Panel curves_panel(const Waterfall& fall) {
  Panel panel{fmt::format("the specimen at {:.3g} 1/s", fall.strain_rate_per_s),
              {"strain", "strain"},
              {"stress", "Pa"},
              {}};
  const auto add = [&](const WaterfallStep& step) {
    panel.series.push_back({name_of(step), step.curve.strain, step.curve.stress_Pa});
  };
  add(fall.steps.front());
  if (fall.steps.size() > 1) {
    add(fall.steps.back());
  }
  return panel;
}

/// How far the curve went between the first and the last model, where it went furthest.
std::string curve_words(const Waterfall& fall) {
  if (fall.steps.size() < 2) {
    return "The specimen's stress at a constant strain rate; there is no second model to compare.";
  }
  const SpecimenCurve& a = fall.steps.front().curve;
  const SpecimenCurve& b = fall.steps.back().curve;
  std::size_t at = 0;
  for (std::size_t i = 0; i < b.stress_Pa.size(); ++i) {
    if (std::abs(b.stress_Pa[i] - a.stress_Pa[i]) > std::abs(b.stress_Pa[at] - a.stress_Pa[at])) {
      at = i;
    }
  }
  return fmt::format(
      "At a constant strain rate the specimen's stress moved most at {:.3g} % strain: from {} to "
      "{}.",
      100.0 * b.strain[at], with_deviation(a.stress_Pa[at], a.sd_Pa[at], "Pa"),
      with_deviation(b.stress_Pa[at], b.sd_Pa[at], "Pa"));
}

/// Models whose numbers say little, whatever their deviations; empty where there are none.
std::string far_words(const Waterfall& fall) {
  std::string names;
  double most = 0.0;
  for (const WaterfallStep& step : fall.steps) {
    if (far_from_fitting(step, fall)) {
      names += (names.empty() ? "" : ", ") + name_of(step);
      most = std::max(most, step.held_out / fall.floor);
    }
  }
  return names.empty() ? ""
                       : fmt::format(
                             "Far from fitting, up to {:.4g} times the noise: {}. What such a fit "
                             "says of its numbers is worth little, whatever their deviations.",
                             most, names);
}

std::string left_words(const Waterfall& fall) {
  const Misfit& last = fall.steps.back().misfit;
  const std::string noise = !fall.allowance.empty() ? "the noise and " + fall.allowance
                            : scattered(fall)       ? "the noise and what differs from shot to shot"
                                                    : "the noise";
  std::string text =
      fmt::format("Of what stood over {}, {:.4g} % is gone.", noise, 100.0 * fall.closed());
  if (fall.closed() >= 1.0) {
    text = "All that stood over " + noise + " is gone.";
  }
  if (fall.steps.front().held_out <= fall.floor) {
    text = "The first model already stands at " + noise + ": there was nothing to take off.";
  }
  text += " What still repeats from shot to shot is ";
  text += fall.allowance.empty()
              ? share_text(fall.repeats / fall.floor) + " of what noise leaves"
              : fmt::format("{:.3g} times the noise, {} {}",
                            last.repeatable_share / last.noise_floor_share,
                            fall.within_allowance ? "within" : "more than", fall.allowance);
  text += fmt::format(", and {} of the signal's energy; noise is {}.",
                      share_text(last.repeatable_share), share_text(last.noise_floor_share));
  return scattered(fall) ? text + fmt::format(
                                      " Beside the noise before the pulses alone the last model "
                                      "leaves {:.4g} per degree of freedom: what differs from "
                                      "shot to shot is more than noise, and what is missing may be "
                                      "among it (`kolsky compare` shows where).",
                                      *fall.last_beside_quiet)
                         : text;
}

}  // namespace

JsonValue describe(const Waterfall& fall) {
  JsonList steps;
  for (const WaterfallStep& step : fall.steps) {
    JsonObject own{{"effect", step.effect},
                   {"removed", step.removed},
                   {"held_out", step.held_out},
                   {"far_from_fitting", far_from_fitting(step, fall)},
                   {"gain", step.gain},
                   {"prior_relief", step.relief},
                   {"better_" + fall.fold, static_cast<std::int64_t>(step.better)},
                   {"misfit", describe(step.misfit)},
                   {"parameters", describe_numbers(step.numbers)},
                   {"strengths", describe_numbers(step.strengths)}};
    if (!step.curve.strain.empty()) {
      own.push_back({"curve", JsonObject{{"strain", step.curve.strain},
                                         {"stress_Pa", step.curve.stress_Pa},
                                         {"stress_sd_Pa", step.curve.sd_Pa}}});
    }
    if (!step.speeds.empty()) {
      own.push_back({"speeds", describe_speeds(step.speeds)});
    }
    steps.push_back(std::move(own));
  }
  JsonObject told{{"steps", std::move(steps)},
                  {"floor", fall.floor},
                  {"repeats", fall.repeats},
                  {"signal", fall.signal},
                  {"closed", fall.closed()},
                  {"strain_rate_per_s", fall.strain_rate_per_s},
                  {"shots", static_cast<std::int64_t>(fall.shots)},
                  {"held_out_by", fall.fold},
                  {"held_out_parts", static_cast<std::int64_t>(fall.folds)}};
  if (fall.last_beside_quiet) {
    told.push_back({"last_beside_quiet", *fall.last_beside_quiet});
  }
  return told;
}

std::string waterfall_text(const Waterfall& fall, const Terminal& terminal) {
  std::string text =
      "misfit on " + fall.fold +
      " the fits did not see, chi2 per residual, logarithmic; ░ is what the effect took off\n\n" +
      bars_text(fall, terminal) + "\n" + drops_text(fall) + "\n";
  for (const std::string& line :
       wrapped(left_words(fall), static_cast<std::size_t>(std::max(40, terminal.columns - 2)))) {
    text += "  " + line + "\n";
  }
  if (!fall.steps.front().speeds.empty()) {
    text +=
        std::string("\n  ") + kSpeedWords + "\n" + table_text(speed_header(fall), speed_rows(fall));
  }
  if (!fitted_numbers(fall).empty()) {
    text += "\n" + table_text(number_header(fall), number_rows(fall));
    for (const std::string& line :
         wrapped(far_words(fall), static_cast<std::size_t>(std::max(40, terminal.columns - 2)))) {
      text += "  " + line + "\n";
    }
  }
  if (!fall.steps.front().curve.strain.empty()) {
    text += "\n" +
            plot_text(curves_panel(fall),
                      {std::min(terminal.columns, static_cast<int>(kMostColumns)), kCurveRows},
                      terminal.colour) +
            "  " + curve_words(fall) + "\n";
  }
  return text;
}

Cascade cascade_of(const Waterfall& fall, const std::string& title) {
  Cascade cascade{
      title, "chi-square per residual, held-out " + fall.fold, noise_of(fall), {}, fall.floor};
  for (const WaterfallStep& step : fall.steps) {
    const std::string note = step.effect.empty() ? ""
                                                 : fmt::format("better in {} of {} {}", step.better,
                                                               fall.folds, fall.fold);
    cascade.steps.push_back({name_of(step), note, step.held_out});
  }
  return cascade;
}

Page waterfall_page(const Waterfall& fall, const std::string& title,
                    const std::vector<std::string>& notes) {
  Page page;
  page.title = title;
  page.headline = left_words(fall);
  page.good = fall.steps.back().held_out < 1.1 * fall.floor && !scattered(fall);
  page.notes = notes;
  PageSection picture{"From the first model to the noise", {}};
  picture.pictures = {cascade_svg(cascade_of(fall, "What each effect took off the misfit"))};
  PageTable drops{
      {"step", "held-out misfit", "chi-square taken off", "better in " + fall.fold, "strength"},
      {}};
  for (const WaterfallStep& step : fall.steps) {
    const bool first = step.effect.empty();
    drops.rows.push_back({name_of(step), fmt::format("{:.4g}", step.held_out),
                          first ? "" : fmt::format("{:.1f}", step.gain),
                          first ? "" : fmt::format("{} of {}", step.better, fall.folds),
                          strengths_text(step)});
  }
  picture.tables.push_back(std::move(drops));
  page.sections.push_back(std::move(picture));
  if (!fall.steps.front().speeds.empty()) {
    PageSection speeds{"The error at every speed", {kSpeedWords}};
    speeds.tables.push_back({speed_header(fall), speed_rows(fall)});
    page.sections.push_back(std::move(speeds));
  }
  if (!fitted_numbers(fall).empty()) {
    PageSection numbers{"How the numbers moved", {}};
    if (const std::string far = far_words(fall); !far.empty()) {
      numbers.text.push_back(far);
    }
    numbers.tables.push_back({number_header(fall), number_rows(fall)});
    page.sections.push_back(std::move(numbers));
  }
  if (!fall.steps.front().curve.strain.empty()) {
    PageSection curves{"The specimen's stress-strain curve", {curve_words(fall)}};
    Panel panel = curves_panel(fall);
    const SpecimenCurve& last = fall.steps.back().curve;
    for (const double side : {2.0, -2.0}) {
      Series edge{side > 0.0 ? "2 deviations above the last" : "below", last.strain,
                  last.stress_Pa};
      for (std::size_t i = 0; i < edge.y.size(); ++i) {
        edge.y[i] += side * last.sd_Pa[i];
      }
      panel.series.push_back(std::move(edge));
    }
    curves.groups.push_back({"first and last model", true, {panel}});
    page.sections.push_back(std::move(curves));
  }
  return page;
}

}  // namespace kolsky::cli
