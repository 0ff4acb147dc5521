#include "drivers/files/store/catalogue.hpp"

#include <sqlite3.h>

#include <fstream>
#include <thread>

#include "tests/scratch_folder.hpp"
#include "tests/unit/files/stored_shots.hpp"

namespace kolsky {
namespace {

using testing::bytes_of;
using testing::expect_refused;
using testing::ScratchFolder;
using testing::write_bytes;

CatalogueEntry entry(int number) {
  CatalogueEntry made;
  made.id = "shot-" + std::to_string(number);
  made.utc_ns = 1'709'210'096'123'456'789 + number;
  made.capture = made.id + ".h5";
  made.verdict = "warn";
  made.reducible = number % 2 == 0;
  made.reason = "it's \"clipped\"; µ";
  made.peak_stress_Pa = 1.0e8 / 3.0 + number;
  made.peak_strain = -0.1 * number;
  return made;
}

void expect_equal(const CatalogueEntry& actual, const CatalogueEntry& expected) {
  EXPECT_EQ(actual.id, expected.id);
  EXPECT_EQ(actual.utc_ns, expected.utc_ns);
  EXPECT_EQ(actual.capture, expected.capture);
  EXPECT_EQ(actual.verdict, expected.verdict);
  EXPECT_EQ(actual.reducible, expected.reducible);
  EXPECT_EQ(actual.reason, expected.reason);
  EXPECT_EQ(actual.peak_stress_Pa, expected.peak_stress_Pa);
  EXPECT_EQ(actual.peak_strain, expected.peak_strain);
}

TEST(Catalogue, KeepsEntriesFromOneOpeningToTheNext) {
  const ScratchFolder folder;
  {
    Catalogue catalogue(folder / "c.sqlite");
    for (const int i : {2, 1, 3}) {
      catalogue.put(entry(i));
    }
  }
  const Catalogue catalogue(folder / "c.sqlite");
  const auto all = catalogue.newest();
  ASSERT_EQ(all.size(), 3U);
  expect_equal(all[0], entry(3));
  expect_equal(all[1], entry(2));
  expect_equal(all[2], entry(1));
  EXPECT_EQ(catalogue.newest(2).size(), 2U);
  EXPECT_EQ(catalogue.newest(2)[1].id, "shot-2");
  expect_equal(catalogue.find("shot-2").value(), entry(2));
  EXPECT_FALSE(catalogue.find("shot-4' OR '1'='1").has_value());
}

TEST(Catalogue, PutReplacesTheEntryOfAnId) {
  const ScratchFolder folder;
  Catalogue catalogue(folder / "c.sqlite");
  catalogue.put(entry(1));
  CatalogueEntry judged = entry(1);
  judged.verdict = "pass";
  catalogue.put(judged);
  ASSERT_EQ(catalogue.newest().size(), 1U);
  EXPECT_EQ(catalogue.newest()[0].verdict, "pass");
}

TEST(Catalogue, ThreadsMayShareIt) {
  const ScratchFolder folder;
  Catalogue catalogue(folder / "c.sqlite");
  std::thread reader([&catalogue] {
    for (int i = 0; i < 200; ++i) {
      (void)catalogue.newest(5);
    }
  });
  for (int i = 0; i < 50; ++i) {
    catalogue.put(entry(i));
  }
  reader.join();
  EXPECT_EQ(catalogue.newest().size(), 50U);
}

class BrokenCatalogue : public ::testing::Test {
 protected:
  BrokenCatalogue() {
    Catalogue catalogue(path_);
    for (int i = 0; i < 300; ++i) {
      catalogue.put(entry(i));
    }
  }
  void expect_replaced() const {
    Catalogue catalogue(path_);
    EXPECT_TRUE(catalogue.newest().empty());
    catalogue.put(entry(1));
    EXPECT_EQ(catalogue.newest().size(), 1U);
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "c.sqlite";
};

TEST_F(BrokenCatalogue, TextIsReplaced) {
  std::ofstream(path_) << std::string(5000, 'x');
  expect_replaced();
}

TEST_F(BrokenCatalogue, ACutOneIsReplaced) {
  auto bytes = bytes_of(path_);
  bytes.resize(bytes.size() / 2);
  write_bytes(path_, bytes);
  expect_replaced();
}

TEST_F(BrokenCatalogue, ADamagedPageIsReplaced) {
  auto bytes = bytes_of(path_);
  constexpr std::size_t kPage = 4096;
  for (std::size_t i = 3 * kPage; i < 4 * kPage; ++i) {
    bytes[i] = std::byte{0x5a};
  }
  write_bytes(path_, bytes);
  expect_replaced();
}

TEST_F(BrokenCatalogue, AnotherVersionIsReplaced) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(database, "PRAGMA user_version = 99", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  expect_replaced();
}

TEST_F(BrokenCatalogue, AnotherProgramsTablesAreReplaced) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
  ASSERT_EQ(
      sqlite3_exec(database, "DROP TABLE shots; CREATE TABLE shots (a); PRAGMA user_version = 0",
                   nullptr, nullptr, nullptr),
      SQLITE_OK);
  sqlite3_close(database);
  expect_replaced();
}

TEST(Catalogue, IsNotReplacedWhereSomebodyElseHoldsIt) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "c.sqlite";
  Catalogue(path).put(entry(1));
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN EXCLUSIVE", nullptr, nullptr, nullptr), SQLITE_OK);
  expect_refused([&] { const Catalogue catalogue(path); }, {"c.sqlite", "locked", "end what else"});
  ASSERT_EQ(sqlite3_exec(other, "ROLLBACK", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(other);
  EXPECT_EQ(Catalogue(path).newest().size(), 1U);
}

TEST(NoCatalogue, AFolderThatIsNotThereIsRefused) {
  const ScratchFolder folder;
  expect_refused([&] { const Catalogue catalogue(folder / "no/c.sqlite"); }, {"no/c.sqlite"});
  std::filesystem::create_directory(folder / "d.sqlite");
  expect_refused([&] { const Catalogue catalogue(folder / "d.sqlite"); }, {"d.sqlite"});
}

}  // namespace
}  // namespace kolsky
