#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace kolsky {

/// A row of the catalogue: what a list of shots shows without opening captures.
struct CatalogueEntry {
  std::string id;
  std::int64_t utc_ns = 0;
  std::string capture;       ///< file name inside store/shots
  std::string verdict;       ///< "pass", "warn", "fail"; empty until judged
  bool reducible = false;
  std::string reason;
  double peak_stress_Pa = 0.0;
  double peak_strain = 0.0;
};

/// Derived data, `store/catalogue.sqlite`; lost or broken, it is made again from the captures.
class Catalogue {
 public:
  explicit Catalogue(const std::filesystem::path& path);
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;

  void put(const CatalogueEntry& entry);
  /// Newest first. @param most 0: all
  [[nodiscard]] std::vector<CatalogueEntry> newest(std::size_t most = 0) const;
  [[nodiscard]] std::optional<CatalogueEntry> find(const std::string& id) const;

 private:
  struct Database;
  std::unique_ptr<Database> database_;
};

}  // namespace kolsky
