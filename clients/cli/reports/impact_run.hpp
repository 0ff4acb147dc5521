#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "clients/terminal/terminal.hpp"
#include "processing/base/bench.hpp"
#include "processing/impact/bench_impact.hpp"
#include "processing/impact/impact.hpp"

namespace kolsky::cli {

/// A material point whose strain rate is followed, as the paper's Fig. 9 numbers them.
struct NamedProbe {
  std::string name;
  impact::Probe probe;
};

/// Points 1 to 3: on the axis 10 mm towards the target, at the centre, 10 mm away.
[[nodiscard]] std::vector<NamedProbe> paper_probes();

/// An impact that was computed, with what it was computed from.
struct ImpactRun {
  Bench bench;
  impact::BallMaterial core;
  impact::BallMaterial cover;
  impact::ImpactModel model;
  impact::MassCheck mass;
  std::vector<std::string> probe_names;
  std::vector<std::string> gauge_names;
  impact::ImpactHistory history;
  double wall_s = 0.0;
};

[[nodiscard]] JsonValue describe(const ImpactRun& run);
[[nodiscard]] std::string report(const ImpactRun& run, const Terminal& terminal);
/// The page that --svg writes.
[[nodiscard]] std::string page(const ImpactRun& run);

/// The meshes that the figures are of [elements, about]: the second shows what the first leaves.
struct FigureMeshes {
  std::size_t coarse = 2048;
  std::size_t fine = 8192;
};

/// Writes the paper's figures 11 to 15 into a folder that is made for them: pictures, a table of
/// every run, and the mesh error beside each trend. The ball is the bench's, and with the usual
/// core of 38 mm. Runs on all processors. Where it fails nothing is left of the folder.
/// @throws InputError if the folder is there already and not empty
/// @return what to print
[[nodiscard]] std::string write_paper_figures(const Bench& bench, const impact::BallMaterial& core,
                                              const impact::BallMaterial& cover,
                                              const std::string& folder,
                                              const FigureMeshes& meshes = {});

}  // namespace kolsky::cli
