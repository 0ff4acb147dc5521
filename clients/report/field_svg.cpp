#include "clients/report/field_svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "clients/figure/layout.hpp"
#include "clients/report/svg.hpp"

namespace kolsky {
namespace {

constexpr double kMapWidth = 340.0;
constexpr double kMapHeight = 330.0;
constexpr double kMargin = 28.0;
constexpr double kHead = 40.0;
constexpr double kScaleWidth = 110.0;
constexpr int kScaleSteps = 48;

struct Colour {
  double red, green, blue;
};

// Stops of a perceptually even scale that also reads in grey: dark blue to yellow.
constexpr std::array<Colour, 6> kStops = {
    {{26, 28, 88}, {49, 84, 152}, {38, 138, 141}, {82, 181, 114}, {178, 213, 70}, {253, 231, 57}}};

struct Scale {
  double low_Pa = 0.0;
  double high_Pa = 1.0;

  [[nodiscard]] std::string colour(double stress_Pa) const {
    const double place = std::clamp((stress_Pa - low_Pa) / (high_Pa - low_Pa), 0.0, 1.0) *
                         static_cast<double>(kStops.size() - 1);
    const auto low = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
    const double t = place - static_cast<double>(low);
    const auto mixed = [&](double Colour::*part) {
      return std::lround((1.0 - t) * kStops[low].*part + t * kStops[low + 1].*part);
    };
    return fmt::format("#{:02x}{:02x}{:02x}", mixed(&Colour::red), mixed(&Colour::green),
                       mixed(&Colour::blue));
  }
};

// What the elements lie between, without the outermost thousandth on either side.
Scale scale_of(const std::vector<impact::Field>& fields) {
  std::vector<double> stresses;
  for (const impact::Field& field : fields) {
    for (const impact::FieldElement& element : field.elements) {
      stresses.push_back(element.axial_stress_Pa);
    }
  }
  std::sort(stresses.begin(), stresses.end());
  if (stresses.empty() || !(stresses.back() > stresses.front())) {
    return {};
  }
  const std::size_t cut = stresses.size() / 1000;
  return {stresses[cut], stresses[stresses.size() - 1 - cut]};
}

double largest_extent(const std::vector<impact::Field>& fields) {
  double extent_m = 1e-6;
  for (const impact::Field& field : fields) {
    double low_m = 1e9;
    double high_m = -1e9;
    for (const impact::FieldElement& element : field.elements) {
      for (std::size_t k = 0; k < 4; ++k) {
        extent_m = std::max(extent_m, 2.0 * element.r_m[k]);
        low_m = std::min(low_m, element.z_m[k]);
        high_m = std::max(high_m, element.z_m[k]);
      }
    }
    extent_m = std::max(extent_m, high_m - low_m);
  }
  return extent_m;
}

// The axis upright, the target below; one group per half, the left one mirrored.
std::string map(const impact::Field& field, const Scale& scale, double pixels_per_m, double left,
                double top) {
  const double middle = left + 0.5 * kMapWidth;
  const double ground = top + kMapHeight - 30.0;
  double plane_m = 1e9;
  std::string shapes;
  for (const impact::FieldElement& element : field.elements) {
    std::string points;
    for (std::size_t k = 0; k < 4; ++k) {
      points += fmt::format("{}{:.2f},{:.2f}", k == 0 ? "" : " ", element.r_m[k] * pixels_per_m,
                            -element.z_m[k] * pixels_per_m);
      plane_m = std::min(plane_m, element.z_m[k]);
    }
    const std::string colour = scale.colour(element.axial_stress_Pa);
    shapes +=
        fmt::format("<polygon points=\"{}\" fill=\"{}\" stroke=\"{}\"/>", points, colour, colour);
  }
  std::string out = fmt::format(
      "<text class=\"title\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">t = {}</text>\n",
      middle, top - 8.0, with_unit(field.time_s, "s"));
  for (const int side : {1, -1}) {
    out += fmt::format(
        "<g stroke-width=\"0.4\" transform=\"translate({:.2f} {:.2f}) scale({} 1)\">{}</g>\n",
        middle, ground, side, shapes);
  }
  return out + fmt::format(
                   "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#222\" "
                   "stroke-width=\"1.5\"/>\n",
                   left + 10.0, ground - std::min(plane_m, 0.0) * pixels_per_m,
                   left + kMapWidth - 10.0, ground - std::min(plane_m, 0.0) * pixels_per_m);
}

std::string colour_bar(const Scale& scale, double left, double top) {
  constexpr double kHeight = 240.0;
  constexpr double kWidth = 18.0;
  std::string out;
  for (int i = 0; i < kScaleSteps; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / kScaleSteps;
    out += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.2f}\" width=\"{:.1f}\" height=\"{:.2f}\" fill=\"{}\"/>", left,
        top + kHeight * (1.0 - static_cast<double>(i + 1) / kScaleSteps), kWidth,
        kHeight / kScaleSteps + 0.5,
        scale.colour(scale.low_Pa + share * (scale.high_Pa - scale.low_Pa)));
  }
  const AxisLayout axis = lay_out({"axial stress", "Pa"}, {scale.low_Pa, scale.high_Pa}, 8);
  for (const AxisMark& mark : axis.marks) {
    out +=
        fmt::format("<text class=\"mark\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", left + kWidth + 6.0,
                    top + kHeight * (1.0 - axis.range.fraction(mark.at)) + 4.0, mark.label);
  }
  return out + fmt::format("<text class=\"mark\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", left - 8.0,
                           top + kHeight + 22.0, axis.title);
}

// The page of panels without its XML head, so that it can stand inside another.
std::string panels_inside(const Figure& figure, double top) {
  std::string page = render_svg(figure);
  page.erase(0, page.find("<svg"));
  return page.insert(4, fmt::format(" x=\"0\" y=\"{:.0f}\"", top));
}

double number_after(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key);
  return at == std::string::npos ? 0.0 : std::stod(text.substr(at + key.size()));
}

}  // namespace

std::string render_fields_svg(const std::vector<impact::Field>& fields, const Figure& figure) {
  const double maps_height = fields.empty() ? 0.0 : kHead + kMapHeight;
  const std::string panels = panels_inside(figure, maps_height);
  const double width =
      std::max(number_after(panels, " width=\""),
               2.0 * kMargin + kScaleWidth + kMapWidth * static_cast<double>(fields.size()));
  const double height = maps_height + number_after(panels, " height=\"");
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width, height);
  const Scale scale = scale_of(fields);
  const double pixels_per_m = (kMapHeight - 60.0) / largest_extent(fields);
  for (std::size_t i = 0; i < fields.size(); ++i) {
    out += map(fields[i], scale, pixels_per_m, kMargin + kMapWidth * static_cast<double>(i), kHead);
  }
  if (!fields.empty()) {
    out += colour_bar(scale, kMargin + kMapWidth * static_cast<double>(fields.size()) + 14.0,
                      kHead + 30.0);
  }
  return out + panels + "</svg>\n";
}

}  // namespace kolsky
