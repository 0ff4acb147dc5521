#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "drivers/files/captures/hdf5_handles.hpp"

/// Reading that takes nothing for granted: only plain objects of the expected type and no larger
/// than the file can hold them; no links to elsewhere, no filters, no external or virtual storage.
/// Everything throws hdf5::Failure.
namespace kolsky::hdf5 {

[[nodiscard]] File open_file(const std::filesystem::path& path);

/// A group with what its messages and limits need.
class GroupReader {
 public:
  /// @param file_bytes  no content is larger
  GroupReader(const File& file, std::uint64_t file_bytes);
  [[nodiscard]] GroupReader group(const std::string& name) const;

  [[nodiscard]] bool has(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> names() const;

  [[nodiscard]] std::string text(const std::string& name) const;
  [[nodiscard]] std::int64_t integer(const std::string& name) const;
  [[nodiscard]] double number(const std::string& name) const;
  /// Rows of `columns` integers.
  [[nodiscard]] std::vector<std::int64_t> table(const std::string& name, std::size_t columns) const;

  [[nodiscard]] std::string text_attribute(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> texts_attribute(const std::string& name) const;
  [[nodiscard]] std::int32_t integer_attribute(const std::string& name) const;

  [[nodiscard]] class DatasetReader dataset(const std::string& name) const;

 private:
  GroupReader(Group group, std::string place, std::uint64_t file_bytes);

  Group group_;
  std::string place_;
  std::uint64_t file_bytes_;
};

/// A plain array in a file.
class DatasetReader {
 public:
  DatasetReader(hid_t group, const std::string& name, const std::string& place,
                std::uint64_t file_bytes);

  [[nodiscard]] const std::string& place() const { return place_; }
  /// Whether the elements are stored as exactly this type.
  [[nodiscard]] bool stores(hid_t type) const;
  /// Reads all elements. @pre stores(file_type); T is its native form
  template <typename T>
  [[nodiscard]] std::vector<T> values(hid_t file_type, int rank) const;
  [[nodiscard]] std::string text() const;
  [[nodiscard]] const std::vector<hsize_t>& extents() const { return extents_; }

  [[nodiscard]] bool has_attribute(const std::string& name) const;
  [[nodiscard]] std::string text_attribute(const std::string& name) const;
  [[nodiscard]] double number_attribute(const std::string& name) const;
  [[nodiscard]] std::int32_t integer_attribute(const std::string& name) const;

 private:
  void read(hid_t type, void* out) const;

  Dataset dataset_;
  std::string place_;
  std::vector<hsize_t> extents_;
  std::size_t elements_ = 0;
};

extern template std::vector<std::int16_t> DatasetReader::values(hid_t, int) const;
extern template std::vector<std::int32_t> DatasetReader::values(hid_t, int) const;
extern template std::vector<std::int64_t> DatasetReader::values(hid_t, int) const;
extern template std::vector<double> DatasetReader::values(hid_t, int) const;

}  // namespace kolsky::hdf5
