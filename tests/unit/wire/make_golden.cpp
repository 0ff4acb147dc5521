// Writes what is missing in proto/golden: bytes of new fixtures, lines of new fields. Run by hand
// after an addition to the schema; what is there already is never touched.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>

#include "tests/unit/wire/golden_messages.hpp"

namespace {

namespace fs = std::filesystem;

void write_fixture(const fs::path& path, const google::protobuf::Message& message) {
  if (fs::exists(path)) {
    return;
  }
  std::ofstream(path, std::ios::binary) << kolsky::golden::deterministic_bytes(message);
  std::cout << "new: " << path.string() << "\n";
}

void write_schema(const fs::path& path) {
  std::set<std::string> lines;
  std::ifstream recorded(path);
  for (std::string line; std::getline(recorded, line);) {
    lines.insert(line);
  }
  recorded.close();
  lines.merge([] {
    const std::vector<std::string> now = kolsky::golden::schema_lines();
    return std::set<std::string>(now.begin(), now.end());
  }());
  std::ofstream file(path);
  for (const std::string& line : lines) {
    file << line << "\n";
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_golden FOLDER (proto/golden)\n";
    return 2;
  }
  const fs::path folder = argv[1];
  for (const kolsky::golden::Fixture& fixture : kolsky::golden::fixtures()) {
    write_fixture(folder / (fixture.name + ".bin"), *fixture.message);
  }
  write_schema(folder / "schema.txt");
  return 0;
}
