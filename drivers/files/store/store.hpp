#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace kolsky {

/// Where things are in a store.
struct StoreLayout {
  std::filesystem::path root;
  [[nodiscard]] std::filesystem::path journals() const { return root / "journal"; }
  [[nodiscard]] std::filesystem::path shots() const { return root / "shots"; }
  [[nodiscard]] std::filesystem::path catalogue() const { return root / "catalogue.sqlite"; }
  [[nodiscard]] std::filesystem::path capture_of(const std::string& shot_id) const {
    return shots() / (shot_id + ".h5");
  }
  /// Makes the folders. @throws InputError
  void create() const;
};

/// What `verify_store` and `recover_store` found, for people and for --json.
struct StoreReport {
  struct Problem {
    enum class Kind {
      damaged,
      missing,
      in_journal,  ///< nothing is lost: a journal has the shot, and recovery writes its capture
    };
    std::string file;
    std::string text;
    Kind kind = Kind::damaged;
  };
  std::size_t journals = 0;
  std::size_t journaled_shots = 0;
  std::size_t captures = 0;
  std::uint64_t bytes_ignored = 0;  ///< torn ends of journals: harmless, counted
  std::size_t temporary_files =
      0;  ///< removed by recovery: what a crash left of captures being written
  std::vector<std::string> recovered;  ///< ids whose capture was written from the journal
  std::vector<std::string> set_aside;  ///< damaged captures, by their new names: a journal had the
                                       ///< shot
  std::vector<std::string> pruned;     ///< journals removed: all they held is in captures
  std::size_t pruned_shots = 0;        ///< shots in those
  bool catalogue_read = false;         ///< by verify_store: a crash may leave one that only the
                                       ///< daemon's next start can read
  std::vector<Problem> problems;
};

/// Checks every journal record and every capture against its checksums, that every journaled
/// shot has a capture that says the same, and that every shot of the catalogue is there. Changes
/// nothing.
/// @throws InputError if the folder is not a store
[[nodiscard]] StoreReport verify_store(const StoreLayout& store);

/// What recovery does with journals that have done their work.
enum class DoneJournals {
  keep,
  prune,  ///< removed, once every shot in them has been read back from a capture that says the
          ///< same to the bit, and the captures' names are durable; damaged journals stay
};

/// Removes one journal as recovery does, on the same conditions; nothing else is touched. Where
/// they do not hold it stays, and the report says why.
/// @pre nobody appends to this journal, and every shot in it has been stored
[[nodiscard]] StoreReport prune_journal(const StoreLayout& store,
                                        const std::filesystem::path& journal);

/// Writes the capture of every whole journaled shot that has none, and removes temporary files a
/// crash left. Nothing stored is overwritten: a damaged capture is set aside as ID.h5.damaged, and
/// one that differs from the journal is a problem to report. Killed at any moment, it is done
/// again.
/// @pre nobody appends to the store's journals
/// @throws InputError if the folders cannot be made
[[nodiscard]] StoreReport recover_store(const StoreLayout& store,
                                        DoneJournals done = DoneJournals::keep);

/// Writes the captures of these shots from their journals, as recovery does, while others append
/// to them. It ends at the first that cannot be written, as the next will not be either.
/// @return in `recovered` those that have a capture now
[[nodiscard]] StoreReport file_journaled(const StoreLayout& store,
                                         const std::set<std::string>& shot_ids);

}  // namespace kolsky
