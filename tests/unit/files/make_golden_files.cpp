#include <cstdio>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/store/journal.hpp"
#include "tests/unit/files/stored_shots.hpp"

/// make_golden_files FOLDER: a capture and a journal of each shot that golden_test expects.
int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: make_golden_files FOLDER\n", stderr);
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  for (const auto& [name, version, shot] : kolsky::testing::make_golden_shots()) {
    kolsky::write_capture(shot, folder / (name + ".h5"));
    kolsky::Journal journal(folder / (name + ".kj"));
    journal.append_shot(shot);
    journal.append_stored(shot.id, shot.id + ".h5");
  }
}
