#pragma once

#include <cstddef>
#include <functional>

namespace kolsky {

/// Runs work(index, worker) for every index below `count`, worker below `workers`; returns when all
/// are done. The caller of a pure function decides by it how many threads there are.
struct Workers {
  std::size_t workers = 1;
  std::size_t first = 0;  ///< the worker that the caller itself is
  std::function<void(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work)>
      run = [](std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
        for (std::size_t index = 0; index < count; ++index) {
          work(index, 0);
        }
      };
};

/// One after the other, on a worker that is already at work: for what is called by work shared out.
[[nodiscard]] inline Workers serial_on(std::size_t worker) {
  Workers serial;
  serial.first = worker;
  serial.run = [worker](std::size_t count,
                        const std::function<void(std::size_t, std::size_t)>& work) {
    for (std::size_t index = 0; index < count; ++index) {
      work(index, worker);
    }
  };
  return serial;
}

}  // namespace kolsky
