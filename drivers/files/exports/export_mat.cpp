#include <matio.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <memory>
#include <set>

#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/exports/export_table.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr mode_t kMode = 0644;
constexpr std::size_t kLongestName = 63;  // MATLAB's namelengthmax

using MatFile = std::unique_ptr<mat_t, decltype(&Mat_Close)>;
using MatVariable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

/// A name MATLAB takes, near to `wanted` and not used before.
std::string variable_name(const std::string& wanted, std::set<std::string>& used) {
  std::string name;
  for (const char c : wanted) {
    const bool good = c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0;
    name += good ? c : '_';
  }
  if (name.empty() || std::isalpha(static_cast<unsigned char>(name.front())) == 0) {
    name.insert(0, "x");
  }
  name.resize(std::min(name.size(), kLongestName - 4));
  std::string unique = name;
  for (int i = 2; !used.insert(unique).second; ++i) {
    unique = name + "_" + std::to_string(i);
  }
  return unique;
}

class MatWriter {
 public:
  MatWriter(std::filesystem::path temporary, std::filesystem::path path)
      : temporary_(std::move(temporary)),
        path_(std::move(path)),
        file_(Mat_CreateVer(temporary_.c_str(), "MATLAB 5.0 MAT-file, exported by Kolsky",
                            MAT_FT_MAT5),
              &Mat_Close) {
    if (file_ == nullptr) {
      fail("the file");
    }
  }

  void put(const std::string& wanted, const std::vector<double>& values) {
    std::size_t extents[2] = {values.size(), 1};
    put(wanted, MAT_C_DOUBLE, MAT_T_DOUBLE, extents, values.data());
  }
  void put(const std::string& wanted, const std::string& text) {
    std::size_t extents[2] = {text.empty() ? 0U : 1U, text.size()};
    put(wanted, MAT_C_CHAR, MAT_T_UTF8, extents, text.data());
  }
  /// Hands what is buffered to the file, and reads all of it back: matio does not say what a full
  /// disk has refused.
  void finish() {
    if (Mat_Close(file_.release()) != 0) {
      fail("the file");
    }
    const MatFile written(Mat_Open(temporary_.c_str(), MAT_ACC_RDONLY), &Mat_Close);
    if (written == nullptr) {
      fail("the file");
    }
    for (const MatVariable& variable : variables_) {
      const MatVariable found(Mat_VarRead(written.get(), variable->name), &Mat_VarFree);
      if (found == nullptr || !same(*found, *variable)) {
        fail(variable->name);
      }
    }
  }

 private:
  void put(const std::string& wanted, matio_classes kind, matio_types type, std::size_t* extents,
           const void* data) {
    const std::string name = variable_name(wanted, used_);
    // matio copies the data and leaves this alone, its signature only does not say so.
    MatVariable variable(
        Mat_VarCreate(name.c_str(), kind, type, 2, extents, const_cast<void*>(data), 0),
        &Mat_VarFree);
    if (variable == nullptr ||
        Mat_VarWrite(file_.get(), variable.get(), MAT_COMPRESSION_NONE) != 0) {
      fail(name);
    }
    variables_.push_back(std::move(variable));
  }

  static bool same(const matvar_t& one, const matvar_t& other) {
    return one.class_type == other.class_type && one.rank == other.rank &&
           std::equal(one.dims, one.dims + one.rank, other.dims) && one.nbytes == other.nbytes &&
           (one.nbytes == 0 || std::memcmp(one.data, other.data, one.nbytes) == 0);
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(path_.string() + ": " + what, "cannot be written",
                     "check the folder and the space on the disk");
  }

  std::filesystem::path temporary_;
  std::filesystem::path path_;
  MatFile file_;
  std::vector<MatVariable> variables_;
  std::set<std::string> used_;
};

}  // namespace

void export_mat(const Shot& shot, const Reduction& reduction, const std::filesystem::path& path) {
  NewFile file(path);
  MatWriter writer(file.temporary(), path);
  for (const ExportColumn& column : history_table(reduction)) {
    writer.put(column.name, column.values);
  }
  const ExportTable gauges = gauge_table(shot);
  writer.put("gauge_time_s", gauges.front().values);
  for (auto column = gauges.begin() + 1; column != gauges.end(); ++column) {
    writer.put(column->name, column->values);
  }
  writer.put("shot_id", shot.id);
  writer.put("bench_toml", shot.bench_toml);
  writer.put("reason", reduction.quality.reason);
  writer.finish();
  file.publish(kMode);
}

}  // namespace kolsky
