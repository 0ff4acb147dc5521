#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kolsky::hdf5 {

/// Debian's HDF5 is not thread-safe: whoever calls it holds a session, one at a time in the
/// program. The library's own printing of errors is off meanwhile.
class Session {
 public:
  Session();

 private:
  std::scoped_lock<std::mutex> lock_;
};

/// What went wrong at which object, for an InputError that adds the file.
class Failure : public std::runtime_error {
 public:
  Failure(std::string object, std::string problem)
      : std::runtime_error(object + ": " + problem),
        object_(std::move(object)),
        problem_(std::move(problem)) {}
  [[nodiscard]] const std::string& object() const { return object_; }
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::string object_;
  std::string problem_;
};

/// Passes a result of the library on. @throws Failure with the library's reason if it is negative
template <typename Result>
Result require(Result result, std::string_view object);
extern template int require<int>(int, std::string_view);
extern template std::int64_t require<std::int64_t>(std::int64_t, std::string_view);

/// Owns one of the library's identifiers.
template <herr_t (*Close)(hid_t)>
class Handle {
 public:
  Handle(hid_t id, std::string_view object) : id_(require(id, object)) {}
  ~Handle() {
    if (id_ >= 0) {
      Close(id_);
    }
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Handle& operator=(Handle&&) = delete;
  /// Gives the identifier up to whoever closes it.
  [[nodiscard]] hid_t release() noexcept { return std::exchange(id_, -1); }
  operator hid_t() const noexcept { return id_; }  // NOLINT(google-explicit-constructor)

 private:
  hid_t id_;
};

using File = Handle<H5Fclose>;
using Group = Handle<H5Gclose>;
using Dataset = Handle<H5Dclose>;
using Space = Handle<H5Sclose>;
using Type = Handle<H5Tclose>;
using Attribute = Handle<H5Aclose>;
using Properties = Handle<H5Pclose>;

/// A new file, built in memory: HDF5 never sees the disk, as it would hold on to a file that a full
/// one refuses. Its objects carry checksums; HDF5 1.8 and later read it.
/// @param bytes  what belongs on the disk, once the file is closed; outlives it
[[nodiscard]] File create_file(std::vector<std::byte>& bytes);
/// @throws Failure where the file is not complete
void close(File file);

/// A name that can link an object, near to `wanted` and not used before.
[[nodiscard]] std::string link_name(const std::string& wanted, std::set<std::string>& used);

[[nodiscard]] Group make_group(hid_t parent, const std::string& name, const std::string& nx_class);

/// For other readers, as they like it best: of variable length.
void put_attribute(hid_t object, const std::string& name, const std::string& text);
void put_attribute(hid_t object, const std::string& name, const std::vector<std::string>& texts);
/// For reading back: of a fixed length. HDF5 keeps texts of variable length in a heap without
/// checksums, and crashes on a damaged one.
void put_fixed_attribute(hid_t object, const std::string& name, const std::string& text);
void put_fixed_attribute(hid_t object, const std::string& name,
                         const std::vector<std::string>& texts);
void put_attribute(hid_t object, const std::string& name, double number);
void put_attribute(hid_t object, const std::string& name, std::int32_t number);

/// Writes a whole array as the file type that matches it.
Dataset put_array(hid_t group, const std::string& name, std::span<const double> values);
Dataset put_array(hid_t group, const std::string& name, std::span<const std::int16_t> values);
Dataset put_array(hid_t group, const std::string& name, std::span<const std::int32_t> values);
/// Rows of `columns` values each.
Dataset put_table(hid_t group, const std::string& name, std::span<const std::int64_t> values,
                  std::size_t columns);
Dataset put_number(hid_t group, const std::string& name, std::int64_t number);
Dataset put_number(hid_t group, const std::string& name, double number);
/// UTF-8 of a fixed length, so that a reader knows its size before it makes room.
Dataset put_text(hid_t group, const std::string& name, const std::string& text);

}  // namespace kolsky::hdf5
