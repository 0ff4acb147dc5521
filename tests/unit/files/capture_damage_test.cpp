#include <hdf5.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <random>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/capture_seal.hpp"
#include "drivers/files/captures/hdf5_handles.hpp"
#include "drivers/files/captures/shot_codec.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/unit/files/stored_shots.hpp"

#ifdef KOLSKY_SANITIZED
// HDF5 drops what it had allocated when it refuses a damaged object header.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}
#endif

namespace kolsky {
namespace {

using testing::bytes_of;
using testing::expect_refused;
using testing::make_shot;
using testing::ScratchFolder;
using testing::write_bytes;

constexpr std::size_t kSealBytes = 95;

std::vector<std::byte> without_seal(const std::vector<std::byte>& bytes) {
  return {bytes.begin(), bytes.end() - kSealBytes};
}

void flip(std::vector<std::byte>& bytes, std::size_t position, unsigned bit) {
  bytes.at(position) ^= static_cast<std::byte>(1U << bit);
}

/// The HDF5 part of a capture, sealed again: what a change by someone who knows the seal looks
/// like.
void write_resealed(const std::filesystem::path& path, const std::vector<std::byte>& image) {
  write_bytes(path, image);
  std::ofstream(path, std::ios::app) << seal_of(image);
}

class DamagedCapture : public ::testing::Test {
 protected:
  DamagedCapture() {
    write_capture(shot_, whole_);
    sealed_ = bytes_of(whole_);
    image_ = without_seal(sealed_);
  }

  /// Where the bytes of some numbers are in the file. @pre once
  template <typename Number>
  [[nodiscard]] std::size_t position_of(const std::vector<Number>& numbers) const {
    const auto wanted = std::as_bytes(std::span(numbers));
    const auto found = std::search(image_.begin(), image_.end(), wanted.begin(), wanted.end());
    EXPECT_NE(found, image_.end());
    return static_cast<std::size_t>(found - image_.begin());
  }

  ScratchFolder folder_;
  Shot shot_ = make_shot(1);
  std::filesystem::path whole_ = folder_ / "whole.h5";
  std::filesystem::path path_ = folder_ / "damaged.h5";
  std::vector<std::byte> sealed_;
  std::vector<std::byte> image_;
};

TEST_F(DamagedCapture, AnyFlippedBitIsFound) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    auto bytes = sealed_;
    // Every third one in the seal itself.
    const std::size_t from = i % 3 == 0 ? image_.size() : 0;
    flip(bytes, from + random() % (bytes.size() - from), random() % 8);
    write_bytes(path_, bytes);
    expect_refused([&] { (void)read_capture(path_); }, {"damaged.h5"});
  }
}

TEST_F(DamagedCapture, AnyCutIsFound) {
  std::mt19937 random(2);
  std::vector<std::size_t> lengths{0, 1, 7, 8, 94, 95, 96, image_.size(), sealed_.size() - 1};
  for (int i = 0; i < 100; ++i) {
    lengths.push_back(random() % sealed_.size());
  }
  for (const std::size_t length : lengths) {
    write_bytes(path_, {sealed_.begin(), sealed_.begin() + static_cast<std::ptrdiff_t>(length)});
    expect_refused([&] { (void)read_capture(path_); }, {"damaged.h5"});
  }
}

TEST_F(DamagedCapture, WhatFollowsTheSealIsFound) {
  sealed_.push_back(std::byte{'\n'});
  write_bytes(path_, sealed_);
  expect_refused([&] { (void)read_capture(path_); }, {"damaged.h5"});
}

// Below the seal the codes and the metadata have digests of their own.
TEST_F(DamagedCapture, ACodeChangedUnderTheSealIsFound) {
  std::vector<std::int16_t> codes(shot_.channels[1].codes.begin(), shot_.channels[1].codes.end());
  const std::size_t at = position_of(codes);
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    auto image = image_;
    flip(image, at + random() % (codes.size() * sizeof(codes[0])), random() % 8);
    write_resealed(path_, image);
    expect_refused([&] { (void)read_capture(path_); }, {"/entry/raw/g2", "SHA-256"});
  }
}

TEST_F(DamagedCapture, MetadataChangedUnderTheSealIsFound) {
  const std::vector<char> bench(shot_.bench_toml.begin(), shot_.bench_toml.end());
  const std::vector<std::int64_t> gap{shot_.gaps[0].first_tick, shot_.gaps[0].samples};
  const std::vector<char> fact{'1', '2', '.', '5'};
  for (const std::size_t at : {position_of(bench), position_of(gap), position_of(fact),
                               position_of(std::vector<std::int64_t>{shot_.utc_ns})}) {
    auto image = image_;
    flip(image, at, 0);
    write_resealed(path_, image);
    expect_refused([&] { (void)read_capture(path_); }, {"/entry/shot", "SHA-256"});
  }
}

// Anywhere else a flip either is refused or is where it does not matter: HDF5's own padding, and
// the plotted copy of the codes.
TEST_F(DamagedCapture, NoFlipUnderTheSealGivesAnotherShot) {
  std::vector<std::byte> expected;
  encode_shot(shot_, expected);
  std::mt19937 random(4);
  int refused = 0;
  constexpr int kFlips = 1000;
  for (int i = 0; i < kFlips; ++i) {
    auto image = image_;
    flip(image, random() % image.size(), random() % 8);
    write_resealed(path_, image);
    try {
      std::vector<std::byte> actual;
      encode_shot(read_capture(path_), actual);
      ASSERT_EQ(actual, expected);
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, kFlips / 20);
}

TEST(NoCapture, IsRefused) {
  const ScratchFolder folder;
  std::ofstream(folder / "text.h5") << "time_s,g1\n0,1\n" << std::string(1000, '1');
  std::ofstream(folder / "empty.h5").flush();
  std::filesystem::create_directory(folder / "folder.h5");
  ASSERT_EQ(::mkfifo((folder / "pipe.h5").c_str(), 0600), 0);
  expect_refused([&] { (void)read_capture(folder / "text.h5"); }, {"text.h5", "is not a capture"});
  expect_refused([&] { (void)read_capture(folder / "empty.h5"); }, {"empty.h5"});
  expect_refused([&] { (void)read_capture(folder / "folder.h5"); }, {"folder.h5"});
  expect_refused([&] { (void)read_capture(folder / "pipe.h5"); }, {"pipe.h5"});
  expect_refused([&] { (void)read_capture(folder / "gone.h5"); }, {"gone.h5", "No such file"});
}

/// Something done to a capture's content by its maker, and what the refusal must name.
struct Hostile {
  const char* name;
  const char* place;
  void (*change)(hid_t file);
  friend void PrintTo(const Hostile& hostile, std::ostream* out) { *out << hostile.name; }
};

void remove(hid_t file, const char* path) {
  H5Ldelete(file, path, H5P_DEFAULT);
}

hid_t make(hid_t file, const char* path, hid_t type, std::vector<hsize_t> extents,
           hid_t properties = H5P_DEFAULT) {
  remove(file, path);
  const hid_t space =
      extents.empty() ? H5Screate(H5S_SCALAR)
                      : H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
  const hid_t dataset = H5Dcreate2(file, path, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
  H5Sclose(space);
  return dataset;
}

void make_and_close(hid_t file, const char* path, hid_t type, std::vector<hsize_t> extents,
                    hid_t properties = H5P_DEFAULT) {
  H5Dclose(make(file, path, type, std::move(extents), properties));
}

void replace_attribute(hid_t file, const char* path, const char* name, hid_t type,
                       std::vector<hsize_t> extents = {}) {
  const hid_t object = H5Oopen(file, path, H5P_DEFAULT);
  H5Adelete(object, name);
  const hid_t space =
      extents.empty() ? H5Screate(H5S_SCALAR)
                      : H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Oclose(object);
}

hid_t chunked(hsize_t chunk) {
  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(properties, 1, &chunk);
  return properties;
}

hid_t variable_text() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  return type;
}

class HostileCapture : public ::testing::TestWithParam<Hostile> {};

TEST_P(HostileCapture, IsRefused) {
  const ScratchFolder folder;
  const auto path = folder / "hostile.h5";
  write_capture(make_shot(1), path);
  write_bytes(path, without_seal(bytes_of(path)));
  {
    const hdf5::Session session;
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    GetParam().change(file);
    ASSERT_GE(H5Fclose(file), 0);
  }
  write_resealed(path, bytes_of(path));
  expect_refused([&] { (void)read_capture(path); }, {"hostile.h5", GetParam().place});
}

INSTANTIATE_TEST_SUITE_P(
    Capture, HostileCapture,
    ::testing::Values(
        Hostile{"no_entry", "/entry", [](hid_t f) { remove(f, "entry"); }},
        Hostile{"no_raw", "/entry/raw", [](hid_t f) { remove(f, "entry/raw"); }},
        Hostile{"no_codes", "/entry/raw/g1", [](hid_t f) { remove(f, "entry/raw/g1"); }},
        Hostile{"raw_is_a_dataset", "/entry/raw",
                [](hid_t f) { make_and_close(f, "entry/raw", H5T_STD_I16LE, {4}); }},
        Hostile{"codes_are_a_group", "/entry/raw/g1",
                [](hid_t f) {
                  remove(f, "entry/raw/g1");
                  H5Gclose(H5Gcreate2(f, "entry/raw/g1", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
                }},
        Hostile{"soft_link", "/entry/raw/g1",
                [](hid_t f) {
                  remove(f, "entry/raw/g1");
                  H5Lcreate_soft("/entry/raw/g2", f, "entry/raw/g1", H5P_DEFAULT, H5P_DEFAULT);
                }},
        Hostile{"external_link", "/entry/shot",
                [](hid_t f) {
                  remove(f, "entry/shot");
                  H5Lcreate_external("/etc/passwd", "/", f, "entry/shot", H5P_DEFAULT, H5P_DEFAULT);
                }},
        Hostile{"id_is_a_number", "/entry/shot/id",
                [](hid_t f) { make_and_close(f, "entry/shot/id", H5T_STD_I64LE, {}); }},
        Hostile{"id_of_variable_length", "/entry/shot/id",
                [](hid_t f) { make_and_close(f, "entry/shot/id", variable_text(), {}); }},
        Hostile{"id_is_a_list", "/entry/shot/id",
                [](hid_t f) { make_and_close(f, "entry/shot/id", H5T_C_S1, {3}); }},
        Hostile{"huge_text", "/entry/shot/bench_toml",
                [](hid_t f) {
                  const hid_t type = H5Tcopy(H5T_C_S1);
                  H5Tset_size(type, 3'000'000'000U);
                  make_and_close(f, "entry/shot/bench_toml", type, {});
                }},
        Hostile{
            "rate_is_a_float", "/entry/shot/rate_numerator",
            [](hid_t f) { make_and_close(f, "entry/shot/rate_numerator", H5T_IEEE_F64LE, {}); }},
        Hostile{"rate_is_big_endian", "/entry/shot/rate_numerator",
                [](hid_t f) { make_and_close(f, "entry/shot/rate_numerator", H5T_STD_I64BE, {}); }},
        Hostile{"gaps_of_two_columns", "/entry/shot/gaps",
                [](hid_t f) {
                  const hid_t table = make(f, "entry/shot/gaps", H5T_STD_I64LE, {2, 2});
                  const std::int64_t rows[4] = {};
                  H5Dwrite(table, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows);
                  H5Dclose(table);
                }},
        Hostile{"gaps_in_three_dimensions", "/entry/shot/gaps",
                [](hid_t f) {
                  make_and_close(f, "entry/shot/gaps", H5T_STD_I64LE, {1, 1, 3});
                }},
        Hostile{"codes_are_floats", "/entry/raw/g1",
                [](hid_t f) { make_and_close(f, "entry/raw/g1", H5T_IEEE_F64LE, {500}); }},
        Hostile{"codes_never_written", "/entry/raw/g1",
                [](hid_t f) { make_and_close(f, "entry/raw/g1", H5T_STD_I16LE, {500}); }},
        Hostile{"huge_codes", "/entry/raw/g1",
                [](hid_t f) {
                  make_and_close(f, "entry/raw/g1", H5T_STD_I16LE, {hsize_t{1} << 45U},
                                 chunked(1024));
                }},
        Hostile{"huge_codes_in_two_dimensions", "/entry/raw/g1",
                [](hid_t f) {
                  make_and_close(f, "entry/raw/g1", H5T_STD_I16LE, {20'000, hsize_t{1} << 40U});
                }},
        Hostile{
            "codes_in_chunks", "/entry/raw/g1",
            [](hid_t f) { make_and_close(f, "entry/raw/g1", H5T_STD_I16LE, {500}, chunked(100)); }},
        Hostile{"codes_in_another_file", "/entry/raw/g1",
                [](hid_t f) {
                  const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
                  H5Pset_external(properties, "/etc/passwd", 0, 1000);
                  make_and_close(f, "entry/raw/g1", H5T_STD_I16LE, {500}, properties);
                }},
        Hostile{"scale_is_a_text", "/entry/raw/g1/@scale",
                [](hid_t f) { replace_attribute(f, "entry/raw/g1", "scale", variable_text()); }},
        Hostile{"unit_is_a_number", "/entry/raw/g1/@unit",
                [](hid_t f) { replace_attribute(f, "entry/raw/g1", "unit", H5T_STD_I32LE); }},
        Hostile{"unit_is_a_list", "/entry/raw/g1/@unit",
                [](hid_t f) { replace_attribute(f, "entry/raw/g1", "unit", H5T_C_S1, {7}); }},
        Hostile{"digest_is_a_number", "/entry/raw/g1/@sha256",
                [](hid_t f) { replace_attribute(f, "entry/raw/g1", "sha256", H5T_IEEE_F64LE); }},
        Hostile{"bits_are_a_list", "/entry/raw/g1/@bits",
                [](hid_t f) { replace_attribute(f, "entry/raw/g1", "bits", H5T_STD_I32LE, {7}); }},
        Hostile{"channels_are_numbers", "/entry/raw/@channels",
                [](hid_t f) { replace_attribute(f, "entry/raw", "channels", H5T_STD_I32LE, {2}); }},
        Hostile{
            "channels_are_null", "/entry/raw/",
            [](hid_t f) { replace_attribute(f, "entry/raw", "channels", variable_text(), {2}); }},
        Hostile{"later_format", "/entry/shot/@format",
                [](hid_t f) {
                  replace_attribute(f, "entry/shot", "format", H5T_STD_I32LE);
                  const hid_t a =
                      H5Aopen_by_name(f, "entry/shot", "format", H5P_DEFAULT, H5P_DEFAULT);
                  const std::int32_t two = 2;
                  H5Awrite(a, H5T_NATIVE_INT32, &two);
                  H5Aclose(a);
                }},
        Hostile{"no_digest", "/entry/shot/@sha256",
                [](hid_t f) { H5Adelete_by_name(f, "entry/shot", "sha256", H5P_DEFAULT); }},
        Hostile{"meta_is_a_number", "/entry/shot/meta/specimen",
                [](hid_t f) { make_and_close(f, "entry/shot/meta/specimen", H5T_STD_I64LE, {}); }},
        Hostile{"meta_removed", "/entry/shot",
                [](hid_t f) { remove(f, "entry/shot/meta/specimen"); }},
        Hostile{"no_bar_model", "/entry/shot",
                [](hid_t f) { remove(f, "entry/shot/bar_model_toml"); }}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace kolsky
