#include "drivers/files/captures/hdf5_handles.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <new>

namespace kolsky::hdf5 {

namespace {

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// What the library's innermost function says, which is the one that names the cause.
std::string library_reason() {
  std::string reason;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned depth, const H5E_error2_t* error, void* out) -> herr_t {
        if (depth == 0 && error->desc != nullptr) {
          *static_cast<std::string*>(out) = error->desc;
        }
        return 0;
      },
      &reason);
  H5Eclear2(H5E_DEFAULT);
  return reason.empty() ? "HDF5 refuses it" : reason;
}

Space space_of(std::span<const hsize_t> extents, const std::string& name) {
  return {H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), name};
}

Space scalar_space() {
  return {H5Screate(H5S_SCALAR), "a scalar"};
}

/// Without times of change, so that the same shot gives the same bytes.
Properties dataset_properties() {
  Properties properties(H5Pcreate(H5P_DATASET_CREATE), "dataset properties");
  require(H5Pset_obj_track_times(properties, false), "dataset properties");
  return properties;
}

Dataset put(hid_t group, const std::string& name, hid_t file_type, hid_t memory_type,
            const Space& space, const void* values) {
  const Properties properties = dataset_properties();
  Dataset dataset(
      H5Dcreate2(group, name.c_str(), file_type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
      name);
  if (H5Sget_simple_extent_npoints(space) > 0) {
    require(H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
  }
  return dataset;
}

template <typename Number>
Dataset put_numbers(hid_t group, const std::string& name, hid_t file_type, hid_t memory_type,
                    std::span<const Number> values) {
  const std::array<hsize_t, 1> extents{values.size()};
  return put(group, name, file_type, memory_type, space_of(extents, name), values.data());
}

/// A type of no bytes does not exist: an empty text is one NUL of padding.
Type utf8_type(std::size_t size) {
  Type type(H5Tcopy(H5T_C_S1), "string type");
  require(H5Tset_size(type, size), "string type");
  require(H5Tset_cset(type, H5T_CSET_UTF8), "string type");
  require(H5Tset_strpad(type, size == H5T_VARIABLE ? H5T_STR_NULLTERM : H5T_STR_NULLPAD),
          "string type");
  return type;
}

void put_attribute(hid_t object, const std::string& name, hid_t file_type, hid_t memory_type,
                   const Space& space, const void* values) {
  const Attribute attribute(
      H5Acreate2(object, name.c_str(), file_type, space, H5P_DEFAULT, H5P_DEFAULT), "@" + name);
  require(H5Awrite(attribute, memory_type, values), "@" + name);
}

/// The length of a file, by the "end of file address" of a superblock of version 2.
std::size_t length_of(const std::byte* superblock) {
  constexpr std::size_t kEndOfFile = 28;
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < sizeof length; ++i) {
    length |= std::to_integer<std::uint64_t>(superblock[kEndOfFile + i]) << (8 * i);
  }
  return length;
}

/// What the library calls to free the memory of a file: the last time, the file is complete.
herr_t keep_image(void* image, H5FD_file_image_op_t operation, void* kept) {
  herr_t result = 0;
  if (operation == H5FD_FILE_IMAGE_OP_FILE_CLOSE && image != nullptr) {
    try {
      const auto* first = static_cast<const std::byte*>(image);
      static_cast<std::vector<std::byte>*>(kept)->assign(first, first + length_of(first));
    } catch (const std::bad_alloc&) {
      result = -1;
    }
  }
  std::free(image);
  return result;
}

}  // namespace

Session::Session() : lock_(library_mutex()) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

template <typename Result>
Result require(Result result, std::string_view object) {
  if (result < 0) {
    throw Failure(std::string(object), library_reason());
  }
  return result;
}
template int require<int>(int, std::string_view);
template std::int64_t require<std::int64_t>(std::int64_t, std::string_view);

File create_file(std::vector<std::byte>& bytes) {
  constexpr std::size_t kGrowBytes = std::size_t{1} << 20U;
  const Properties access(H5Pcreate(H5P_FILE_ACCESS), "file properties");
  require(H5Pset_fapl_core(access, kGrowBytes, false), "file properties");
  require(H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18), "file properties");
  H5FD_file_image_callbacks_t callbacks{};
  callbacks.image_malloc = [](std::size_t size, H5FD_file_image_op_t, void*) {
    return std::malloc(size);
  };
  callbacks.image_realloc = [](void* image, std::size_t size, H5FD_file_image_op_t, void*) {
    return std::realloc(image, size);
  };
  callbacks.image_free = keep_image;
  callbacks.udata_copy = [](void* kept) { return kept; };
  callbacks.udata_free = [](void*) { return herr_t{0}; };
  callbacks.udata = &bytes;
  require(H5Pset_file_image_callbacks(access, &callbacks), "file properties");
  return {H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access), "the file"};
}

void close(File file) {
  require(H5Fclose(file.release()), "the file");
}

std::string link_name(const std::string& wanted, std::set<std::string>& used) {
  std::string name = wanted;
  std::replace(name.begin(), name.end(), '/', '_');
  if (name.empty() || name == ".") {
    name = "unnamed";
  }
  while (!used.insert(name).second) {
    name += "_";
  }
  return name;
}

Group make_group(hid_t parent, const std::string& name, const std::string& nx_class) {
  const Properties properties(H5Pcreate(H5P_GROUP_CREATE), "group properties");
  require(H5Pset_obj_track_times(properties, false), "group properties");
  Group group(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, properties, H5P_DEFAULT), name);
  put_attribute(group, "NX_class", nx_class);
  return group;
}

void put_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Type type = utf8_type(H5T_VARIABLE);
  const char* pointer = text.c_str();
  put_attribute(object, name, type, type, scalar_space(), static_cast<const void*>(&pointer));
}

void put_attribute(hid_t object, const std::string& name, const std::vector<std::string>& texts) {
  const Type type = utf8_type(H5T_VARIABLE);
  std::vector<const char*> pointers;
  pointers.reserve(texts.size());
  for (const std::string& text : texts) {
    pointers.push_back(text.c_str());
  }
  const std::array<hsize_t, 1> extents{texts.size()};
  put_attribute(object, name, type, type, space_of(extents, name),
                static_cast<const void*>(pointers.data()));
}

void put_fixed_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Type type = utf8_type(std::max<std::size_t>(text.size(), 1));
  put_attribute(object, name, type, type, scalar_space(), text.c_str());
}

void put_fixed_attribute(hid_t object, const std::string& name,
                         const std::vector<std::string>& texts) {
  std::size_t size = 1;
  for (const std::string& text : texts) {
    size = std::max(size, text.size());
  }
  std::string padded;
  for (const std::string& text : texts) {
    padded += text + std::string(size - text.size(), '\0');
  }
  const Type type = utf8_type(size);
  const std::array<hsize_t, 1> extents{texts.size()};
  put_attribute(object, name, type, type, space_of(extents, name), padded.data());
}

void put_attribute(hid_t object, const std::string& name, double number) {
  put_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, scalar_space(), &number);
}

void put_attribute(hid_t object, const std::string& name, std::int32_t number) {
  put_attribute(object, name, H5T_STD_I32LE, H5T_NATIVE_INT32, scalar_space(), &number);
}

Dataset put_array(hid_t group, const std::string& name, std::span<const double> values) {
  return put_numbers(group, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values);
}

Dataset put_array(hid_t group, const std::string& name, std::span<const std::int16_t> values) {
  return put_numbers(group, name, H5T_STD_I16LE, H5T_NATIVE_INT16, values);
}

Dataset put_array(hid_t group, const std::string& name, std::span<const std::int32_t> values) {
  return put_numbers(group, name, H5T_STD_I32LE, H5T_NATIVE_INT32, values);
}

Dataset put_table(hid_t group, const std::string& name, std::span<const std::int64_t> values,
                  std::size_t columns) {
  const std::array<hsize_t, 2> extents{values.size() / columns, columns};
  return put(group, name, H5T_STD_I64LE, H5T_NATIVE_INT64, space_of(extents, name), values.data());
}

Dataset put_number(hid_t group, const std::string& name, std::int64_t number) {
  return put(group, name, H5T_STD_I64LE, H5T_NATIVE_INT64, scalar_space(), &number);
}

Dataset put_number(hid_t group, const std::string& name, double number) {
  return put(group, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, scalar_space(), &number);
}

Dataset put_text(hid_t group, const std::string& name, const std::string& text) {
  const Type type = utf8_type(std::max<std::size_t>(text.size(), 1));
  return put(group, name, type, type, scalar_space(), text.c_str());
}

}  // namespace kolsky::hdf5
