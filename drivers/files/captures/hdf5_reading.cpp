#include "drivers/files/captures/hdf5_reading.hpp"

namespace kolsky::hdf5 {

namespace {

constexpr std::size_t kMostNames = 100'000;
constexpr std::size_t kMostAttributeBytes = std::size_t{1} << 24U;
constexpr int kMostDimensions = 2;

[[noreturn]] void refuse(const std::string& place, const std::string& problem) {
  throw Failure(place, problem);
}

void require_own_link(hid_t parent, const std::string& name, const std::string& place) {
  if (name.empty() || name.find('/') != std::string::npos || name == ".") {
    refuse(place, "is not the name of an object");
  }
  if (H5Lexists(parent, name.c_str(), H5P_DEFAULT) <= 0) {
    refuse(place, "is missing");
  }
  H5L_info_t info;
  require(H5Lget_info(parent, name.c_str(), &info, H5P_DEFAULT), place);
  if (info.type != H5L_TYPE_HARD) {
    refuse(place, "is a link to elsewhere");
  }
}

hid_t open_object(hid_t parent, const std::string& name, const std::string& place,
                  H5I_type_t kind) {
  require_own_link(parent, name, place);
  const hid_t object = require(H5Oopen(parent, name.c_str(), H5P_DEFAULT), place);
  if (H5Iget_type(object) != kind) {
    H5Oclose(object);
    refuse(place, kind == H5I_GROUP ? "is not a group" : "is not a dataset");
  }
  return object;
}

Attribute open_attribute(hid_t object, const std::string& name, const std::string& place) {
  if (H5Aexists(object, name.c_str()) <= 0) {
    refuse(place, "is missing");
  }
  return {H5Aopen(object, name.c_str(), H5P_DEFAULT), place};
}

hsize_t elements_of(const Attribute& attribute, const std::string& place) {
  const Space space(H5Aget_space(attribute), place);
  const auto elements = require(std::int64_t{H5Sget_simple_extent_npoints(space)}, place);
  if (elements < 1 || static_cast<std::size_t>(elements) > kMostNames) {
    refuse(place, "has " + std::to_string(elements) + " elements");
  }
  return static_cast<hsize_t>(elements);
}

template <typename Number>
Number number_attribute_of(hid_t object, const std::string& name, const std::string& place,
                           hid_t file_type, hid_t memory_type) {
  const Attribute attribute = open_attribute(object, name, place);
  const Type type(H5Aget_type(attribute), place);
  if (H5Tequal(type, file_type) <= 0 || elements_of(attribute, place) != 1) {
    refuse(place, "is not one number of the right type");
  }
  Number number{};
  require(H5Aread(attribute, memory_type, &number), place);
  return number;
}

std::string without_padding(std::string text) {
  text.resize(text.find_last_not_of('\0') + 1);
  return text;
}

std::vector<std::string> texts_of(hid_t object, const std::string& name, const std::string& place) {
  const Attribute attribute = open_attribute(object, name, place);
  const Type type(H5Aget_type(attribute), place);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0) {
    refuse(place, "is not a text of a fixed length");
  }
  const std::size_t size = H5Tget_size(type);
  const auto elements = static_cast<std::size_t>(elements_of(attribute, place));
  if (size == 0 || size > kMostAttributeBytes / elements) {
    refuse(place, "is larger than an attribute may be");
  }
  std::string all(elements * size, '\0');
  require(H5Aread(attribute, type, all.data()), place);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < elements; ++i) {
    texts.push_back(without_padding(all.substr(i * size, size)));
  }
  return texts;
}

std::string single_text_of(hid_t object, const std::string& name, const std::string& place) {
  auto texts = texts_of(object, name, place);
  if (texts.size() != 1) {
    refuse(place, "is a list where one text belongs");
  }
  return std::move(texts.front());
}

void require_plain_storage(const Dataset& dataset, const std::string& place) {
  const Properties properties(H5Dget_create_plist(dataset), place);
  const H5D_layout_t kind = H5Pget_layout(properties);
  if ((kind != H5D_CONTIGUOUS && kind != H5D_COMPACT) || H5Pget_external_count(properties) != 0 ||
      H5Pget_nfilters(properties) != 0) {
    refuse(place, "is not stored plainly inside the file");
  }
}

std::vector<hsize_t> extents_of(const Dataset& dataset, const std::string& place) {
  const Space space(H5Dget_space(dataset), place);
  const int rank = require(H5Sget_simple_extent_ndims(space), place);
  if (rank > kMostDimensions || H5Sget_simple_extent_type(space) == H5S_NULL) {
    refuse(place, "has a shape no capture has");
  }
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
  require(H5Sget_simple_extent_dims(space, extents.data(), nullptr), place);
  return extents;
}

}  // namespace

File open_file(const std::filesystem::path& path) {
  const Properties access(H5Pcreate(H5P_FILE_ACCESS), "file properties");
  // Captures never change: no lock is needed, and some file systems have none.
  require(H5Pset_file_locking(access, false, true), "file properties");
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), "the file"};
}

GroupReader::GroupReader(const File& file, std::uint64_t file_bytes)
    : GroupReader(Group(H5Gopen2(file, "/", H5P_DEFAULT), "/"), "", file_bytes) {}

GroupReader::GroupReader(Group group, std::string place, std::uint64_t file_bytes)
    : group_(std::move(group)), place_(std::move(place)), file_bytes_(file_bytes) {}

GroupReader GroupReader::group(const std::string& name) const {
  const std::string place = place_ + "/" + name;
  return {Group(open_object(group_, name, place, H5I_GROUP), place), place, file_bytes_};
}

bool GroupReader::has(const std::string& name) const {
  return H5Lexists(group_, name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> GroupReader::names() const {
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    auto& list = *static_cast<std::vector<std::string>*>(out);
    list.emplace_back(name);
    return list.size() < kMostNames ? 0 : -1;
  };
  require(H5Literate(group_, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names), place_);
  return names;
}

DatasetReader GroupReader::dataset(const std::string& name) const {
  return {group_, name, place_ + "/" + name, file_bytes_};
}

std::string GroupReader::text(const std::string& name) const {
  return dataset(name).text();
}

std::int64_t GroupReader::integer(const std::string& name) const {
  return dataset(name).values<std::int64_t>(H5T_STD_I64LE, 0).front();
}

double GroupReader::number(const std::string& name) const {
  return dataset(name).values<double>(H5T_IEEE_F64LE, 0).front();
}

std::vector<std::int64_t> GroupReader::table(const std::string& name, std::size_t columns) const {
  const auto rows = dataset(name);
  auto values = rows.values<std::int64_t>(H5T_STD_I64LE, 2);
  if (rows.extents()[1] != columns) {
    refuse(rows.place(), "has " + std::to_string(rows.extents()[1]) + " columns in place of " +
                             std::to_string(columns));
  }
  return values;
}

std::string GroupReader::text_attribute(const std::string& name) const {
  return single_text_of(group_, name, place_ + "/@" + name);
}

std::vector<std::string> GroupReader::texts_attribute(const std::string& name) const {
  return texts_of(group_, name, place_ + "/@" + name);
}

std::int32_t GroupReader::integer_attribute(const std::string& name) const {
  return number_attribute_of<std::int32_t>(group_, name, place_ + "/@" + name, H5T_STD_I32LE,
                                           H5T_NATIVE_INT32);
}

DatasetReader::DatasetReader(hid_t group, const std::string& name, const std::string& place,
                             std::uint64_t file_bytes)
    : dataset_(open_object(group, name, place, H5I_DATASET), place),
      place_(place),
      extents_(extents_of(dataset_, place)) {
  require_plain_storage(dataset_, place_);
  const Type type(H5Dget_type(dataset_), place_);
  const std::uint64_t size = H5Tget_size(type);
  std::uint64_t elements = 1;
  for (const hsize_t extent : extents_) {
    if (extent > file_bytes || elements * extent > file_bytes) {
      refuse(place_, "is larger than the file");
    }
    elements *= extent;
  }
  if (size == 0 || size > file_bytes || elements * size > file_bytes ||
      (elements > 0 && H5Dget_storage_size(dataset_) != elements * size)) {
    refuse(place_, "is larger than its content in the file");
  }
  elements_ = static_cast<std::size_t>(elements);
}

bool DatasetReader::stores(hid_t type) const {
  const Type own(H5Dget_type(dataset_), place_);
  return H5Tequal(own, type) > 0;
}

void DatasetReader::read(hid_t type, void* out) const {
  require(H5Dread(dataset_, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out), place_);
}

template <typename T>
std::vector<T> DatasetReader::values(hid_t file_type, int rank) const {
  if (!stores(file_type) || extents_.size() != static_cast<std::size_t>(rank)) {
    refuse(place_, "has the wrong type or shape");
  }
  std::vector<T> out(elements_);
  if (elements_ > 0) {
    const Type native(H5Tget_native_type(file_type, H5T_DIR_ASCEND), place_);
    read(native, out.data());
  }
  return out;
}

template std::vector<std::int16_t> DatasetReader::values(hid_t, int) const;
template std::vector<std::int32_t> DatasetReader::values(hid_t, int) const;
template std::vector<std::int64_t> DatasetReader::values(hid_t, int) const;
template std::vector<double> DatasetReader::values(hid_t, int) const;

std::string DatasetReader::text() const {
  const Type type(H5Dget_type(dataset_), place_);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || !extents_.empty()) {
    refuse(place_, "is not one text of a fixed length");
  }
  std::string text(H5Tget_size(type), '\0');
  read(type, text.data());
  return without_padding(std::move(text));
}

bool DatasetReader::has_attribute(const std::string& name) const {
  return H5Aexists(dataset_, name.c_str()) > 0;
}

std::string DatasetReader::text_attribute(const std::string& name) const {
  return single_text_of(dataset_, name, place_ + "/@" + name);
}

double DatasetReader::number_attribute(const std::string& name) const {
  return number_attribute_of<double>(dataset_, name, place_ + "/@" + name, H5T_IEEE_F64LE,
                                     H5T_NATIVE_DOUBLE);
}

std::int32_t DatasetReader::integer_attribute(const std::string& name) const {
  return number_attribute_of<std::int32_t>(dataset_, name, place_ + "/@" + name, H5T_STD_I32LE,
                                           H5T_NATIVE_INT32);
}

}  // namespace kolsky::hdf5
