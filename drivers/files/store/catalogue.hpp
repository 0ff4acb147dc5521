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
  std::string capture;  ///< file name inside store/shots
  std::string verdict;  ///< "pass", "warn", "fail"; empty where there was nothing to judge: the
                        ///< capture was damaged or missing
  bool reducible = false;
  std::string reason;
  double peak_stress_Pa = 0.0;
  double peak_strain = 0.0;
  double peak_force_N = 0.0;  ///< of a ball on a bar
  double restitution = 0.0;   ///< of the same, by speed or else by impulse; 0 where not known
};

/// The entries of a catalogue that may be in use, and stays as it is; nothing where it is not there
/// or cannot be read without changing it, as after a crash: it is derived data.
[[nodiscard]] std::optional<std::vector<CatalogueEntry>> read_catalogue(
    const std::filesystem::path& path);

/// Derived data, `store/catalogue.sqlite`; lost or broken, it is made again from the captures.
class Catalogue {
 public:
  /// Opens it, or makes it. A file that is no catalogue of this version, or a broken one, is
  /// replaced.
  /// @throws InputError if the folder cannot be written, or somebody else holds the file
  explicit Catalogue(const std::filesystem::path& path);
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;

  /// Adds an entry, or replaces the one with its id. From any thread, as the rest.
  /// @throws std::runtime_error where the database refuses (a full disk)
  void put(const CatalogueEntry& entry);
  /// Newest first. @param most 0: all
  [[nodiscard]] std::vector<CatalogueEntry> newest(std::size_t most = 0) const;
  [[nodiscard]] std::optional<CatalogueEntry> find(const std::string& id) const;

 private:
  struct Database;
  std::unique_ptr<Database> database_;
};

}  // namespace kolsky
