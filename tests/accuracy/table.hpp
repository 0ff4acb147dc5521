#pragma once

#include <optional>
#include <string>
#include <vector>

namespace kolsky::accuracy {

/// One part of the page: a heading, what it is about, a table.
struct Section {
  std::string title;
  std::string text;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// Parts that need data beside the project give none where it is absent.
using Part = std::optional<Section> (*)();

[[nodiscard]] std::string markdown(const Section& section);

/// A number to so many significant digits.
[[nodiscard]] std::string digits(double value, int significant);

/// How many digits two numbers share: -log10 of their relative difference, 7 at most.
[[nodiscard]] std::string agreed(double reference, double ours);

std::optional<Section> elastic_waves();
std::optional<Section> viscoelastic_waves();
std::optional<Section> identified_bars();
std::optional<Section> identified_solid_bars();
std::optional<Section> identified_compliances();
std::optional<Section> identified_specimens();
std::optional<Section> identified_specimen_compliances();
std::optional<Section> separated_waves();
std::optional<Section> reduced_shots();
std::optional<Section> rubber_equilibrium();
std::optional<Section> impacts();

}  // namespace kolsky::accuracy
