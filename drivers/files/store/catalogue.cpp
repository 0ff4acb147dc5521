#include "drivers/files/store/catalogue.hpp"

#include <sqlite3.h>

#include <memory>
#include <mutex>
#include <stdexcept>
#include <system_error>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr int kVersion = 2;
constexpr int kBusy_ms = 2000;

/// The file cannot be gone on with: not a database, damaged, or of another version or program. Not
/// so one that is locked, or on a disk that fails: what is in it may be sound.
class Unusable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void check(sqlite3* database, int result) {
  if (result == SQLITE_OK || result == SQLITE_ROW || result == SQLITE_DONE) {
    return;
  }
  const std::string message =
      database == nullptr ? sqlite3_errstr(result) : sqlite3_errmsg(database);
  if (result == SQLITE_CORRUPT || result == SQLITE_NOTADB || result == SQLITE_ERROR) {
    throw Unusable(message);
  }
  throw std::runtime_error("catalogue: " + message);
}

class Statement {
 public:
  Statement(sqlite3* database, const char* sql) : database_(database) {
    check(database, sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr));
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(const std::string& text) {
    check(database_, sqlite3_bind_text64(statement_, ++bound_, text.data(), text.size(),
                                         SQLITE_TRANSIENT, SQLITE_UTF8));
    return *this;
  }
  Statement& bind(std::int64_t number) {
    check(database_, sqlite3_bind_int64(statement_, ++bound_, number));
    return *this;
  }
  Statement& bind(double number) {
    check(database_, sqlite3_bind_double(statement_, ++bound_, number));
    return *this;
  }
  /// @return whether there is a row
  bool step() {
    const int result = sqlite3_step(statement_);
    check(database_, result);
    return result == SQLITE_ROW;
  }
  [[nodiscard]] std::string text(int column) const {
    const auto* bytes = sqlite3_column_text(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return bytes == nullptr ? "" : std::string(reinterpret_cast<const char*>(bytes), size);
  }
  [[nodiscard]] std::int64_t integer(int column) const {
    return sqlite3_column_int64(statement_, column);
  }
  [[nodiscard]] double number(int column) const {
    return sqlite3_column_double(statement_, column);
  }

 private:
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

constexpr const char* kSelect =
    "SELECT id, utc_ns, capture, verdict, reducible, reason, peak_stress_Pa, peak_strain, "
    "peak_force_N, restitution FROM shots ";

CatalogueEntry entry_of(const Statement& row) {
  CatalogueEntry entry;
  entry.id = row.text(0);
  entry.utc_ns = row.integer(1);
  entry.capture = row.text(2);
  entry.verdict = row.text(3);
  entry.reducible = row.integer(4) != 0;
  entry.reason = row.text(5);
  entry.peak_stress_Pa = row.number(6);
  entry.peak_strain = row.number(7);
  entry.peak_force_N = row.number(8);
  entry.restitution = row.number(9);
  return entry;
}

}  // namespace

struct Catalogue::Database {
  /// @throws Unusable  @throws InputError where the file cannot be reached
  static std::unique_ptr<Database> open(const std::filesystem::path& path) {
    try {
      return std::make_unique<Database>(path);
    } catch (const Unusable&) {
      throw;
    } catch (const InputError&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw InputError(path.string(), std::string("cannot be used now (") + error.what() + ")",
                       "end what else has it open, and look at the disk");
    }
  }

  explicit Database(const std::filesystem::path& path) {
    const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX;
    const int result = sqlite3_open_v2(path.c_str(), &handle, flags, nullptr);
    if (result != SQLITE_OK) {
      const std::string reason =
          handle == nullptr ? sqlite3_errstr(result) : sqlite3_errmsg(handle);
      sqlite3_close(handle);
      throw InputError(path.string(), "cannot be opened (" + reason + ")",
                       "check the folder and its permissions");
    }
    try {
      prepare();
    } catch (...) {
      sqlite3_close(handle);
      throw;
    }
  }
  ~Database() { sqlite3_close(handle); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const char* sql) { check(handle, sqlite3_exec(handle, sql, nullptr, nullptr, nullptr)); }

  void put(const CatalogueEntry& entry) {
    Statement(handle, "INSERT OR REPLACE INTO shots VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
        .bind(entry.id)
        .bind(entry.utc_ns)
        .bind(entry.capture)
        .bind(entry.verdict)
        .bind(std::int64_t{entry.reducible})
        .bind(entry.reason)
        .bind(entry.peak_stress_Pa)
        .bind(entry.peak_strain)
        .bind(entry.peak_force_N)
        .bind(entry.restitution)
        .step();
  }

  sqlite3* handle = nullptr;
  std::mutex mutex;

 private:
  void prepare() {
    sqlite3_busy_timeout(handle, kBusy_ms);
    // Derived data: what a power cut breaks is found at opening and made again.
    run("PRAGMA synchronous = OFF");
    Statement version(handle, "PRAGMA user_version");
    version.step();
    if (version.integer(0) == 0) {
      make();
    } else if (version.integer(0) != kVersion) {
      throw Unusable("another version");
    } else {
      inspect();
    }
  }

  void make() {
    run("BEGIN IMMEDIATE;"
        "CREATE TABLE shots (id TEXT PRIMARY KEY, utc_ns INTEGER NOT NULL, capture TEXT NOT NULL,"
        " verdict TEXT NOT NULL, reducible INTEGER NOT NULL, reason TEXT NOT NULL,"
        " peak_stress_Pa REAL, peak_strain REAL, peak_force_N REAL, restitution REAL);"
        "CREATE INDEX shots_by_time ON shots (utc_ns);"
        "PRAGMA user_version = 2;"
        "COMMIT");
  }

  void inspect() {
    Statement check_pages(handle, "PRAGMA quick_check(1)");
    if (!check_pages.step() || check_pages.text(0) != "ok") {
      throw Unusable("damaged");
    }
    Statement(handle, kSelect).step();
  }
};

std::optional<std::vector<CatalogueEntry>> read_catalogue(const std::filesystem::path& path) {
  sqlite3* handle = nullptr;
  const int opened = sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READONLY, nullptr);
  const std::unique_ptr<sqlite3, decltype(&sqlite3_close)> closing(handle, &sqlite3_close);
  if (opened != SQLITE_OK) {
    return std::nullopt;
  }
  std::vector<CatalogueEntry> entries;
  sqlite3_busy_timeout(handle, kBusy_ms);
  try {
    Statement rows(handle, kSelect);
    while (rows.step()) {
      entries.push_back(entry_of(rows));
    }
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
  return entries;
}

Catalogue::Catalogue(const std::filesystem::path& path) {
  try {
    database_ = Database::open(path);
  } catch (const Unusable&) {
    for (const char* suffix : {"", "-journal", "-wal", "-shm"}) {
      std::error_code ignored;
      std::filesystem::remove(path.string() + suffix, ignored);
    }
    database_ = Database::open(path);
  }
}

Catalogue::~Catalogue() = default;

void Catalogue::put(const CatalogueEntry& entry) {
  const std::scoped_lock lock(database_->mutex);
  database_->put(entry);
}

std::vector<CatalogueEntry> Catalogue::newest(std::size_t most) const {
  const std::scoped_lock lock(database_->mutex);
  const std::string sql = std::string(kSelect) + "ORDER BY utc_ns DESC, id DESC LIMIT ?";
  Statement rows(database_->handle, sql.c_str());
  rows.bind(most == 0 ? std::int64_t{-1} : static_cast<std::int64_t>(most));
  std::vector<CatalogueEntry> entries;
  while (rows.step()) {
    entries.push_back(entry_of(rows));
  }
  return entries;
}

std::optional<CatalogueEntry> Catalogue::find(const std::string& id) const {
  const std::scoped_lock lock(database_->mutex);
  const std::string sql = std::string(kSelect) + "WHERE id = ?";
  Statement row(database_->handle, sql.c_str());
  row.bind(id);
  return row.step() ? std::optional(entry_of(row)) : std::nullopt;
}

}  // namespace kolsky
