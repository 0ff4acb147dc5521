#include <cstdio>

#include "drivers/files/captures/capture.hpp"
#include "drivers/files/store/journal.hpp"
#include "tests/unit/files/stored_shots.hpp"

/// make_golden_files FOLDER: a capture and a journal of the shot that golden_test expects.
int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: make_golden_files FOLDER\n", stderr);
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  const kolsky::Shot shot = kolsky::testing::make_golden_shot();
  kolsky::write_capture(shot, folder / "shot.h5");
  kolsky::Journal journal(folder / "shot.kj");
  journal.append_shot(shot);
  journal.append_stored(shot.id, "golden-1.h5");
}
