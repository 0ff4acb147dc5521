#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/generators/campaign.hpp"

namespace kolsky::scoring {

enum class CaseKind { null, single, tied, two, absorbed, withheld };

[[nodiscard]] std::string name_of(CaseKind kind);

/// One campaign to be diagnosed: what is hidden in it, and in sizes of the smallest that its bench
/// could identify.
struct Case {
  std::string id;
  CaseKind kind = CaseKind::null;
  testing::Campaign campaign;
  testing::Campaign bare;         ///< with nothing hidden
  std::vector<double> multiples;  ///< one per effect
};

/// Where a case lies: the analyser gets `captures` and `bench` alone.
struct CaseFiles {
  std::filesystem::path folder, bench, truth;
  std::filesystem::path bars;         ///< empty where the bench says all about them
  std::filesystem::path core, cover;  ///< of a ball; else empty
  std::string kind;
  std::vector<std::filesystem::path> captures;
};

[[nodiscard]] CaseFiles write_case(const Case& drawn, const std::filesystem::path& root);

}  // namespace kolsky::scoring
