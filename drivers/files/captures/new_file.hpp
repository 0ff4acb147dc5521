#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace kolsky {

/// A file that appears under its name whole or not at all, and never in the place of another: it
/// grows under a temporary name in the same folder, and `publish` makes it durable and gives it its
/// name. Dropped without `publish`, it leaves nothing.
class NewFile {
 public:
  /// @throws InputError if the name is taken or the folder cannot be written
  explicit NewFile(std::filesystem::path path);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Where the content goes until then; for libraries that open files by name.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }

  /// Appends, to what a library wrote as well. @throws InputError, as on a full disk
  void write(std::span<const std::byte> bytes);
  void write(const std::string& text);

  /// fsync, rename without overwriting, fsync of the folder. @throws InputError if the name is
  /// taken by now
  void publish(mode_t mode);

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  int file_ = -1;
};

/// Gives a file another name in its folder, durably.
/// @return false, and nothing is changed, where that name is taken
/// @throws InputError where the folder cannot be written
bool rename_without_overwriting(const std::filesystem::path& from, const std::filesystem::path& to);

/// Puts a text under a name, in the place of what was there: whole or not at all.
/// For what people revise (models, reports); nothing else is ever replaced.
/// @throws InputError if the folder cannot be written, or what is there does not begin as this text
///   does and so is something else (a capture, a bench file)
void replace_file(const std::filesystem::path& path, const std::string& text);

/// What `replace_file` would refuse, before the work whose result it is to put there.
/// @param beginning  of the text that it will be given
/// @throws InputError as `replace_file`
void require_replaceable(const std::filesystem::path& path, const std::string& beginning);

/// Makes a folder's entries durable. @throws InputError
void sync_folder(const std::filesystem::path& folder);

/// Removes what a crash left of `NewFile`s in a folder; those that a living process is writing
/// stay.
/// @return how many were removed
std::size_t remove_abandoned_files(const std::filesystem::path& folder);

}  // namespace kolsky
