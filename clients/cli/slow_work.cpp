#include "clients/cli/slow_work.hpp"

#include <iostream>

#include "clients/terminal/terminal.hpp"

namespace kolsky::cli {
namespace {

constexpr std::chrono::seconds kForAPerson{1};
constexpr std::chrono::seconds kForALog{20};

}  // namespace

SlowWork::SlowWork(std::string command)
    : SlowWork(std::move(command), terminal_of(2).interactive ? kForAPerson : kForALog) {}

SlowWork::SlowWork(std::string command, std::chrono::milliseconds every)
    : command_(std::move(command)), every_(every) {}

void SlowWork::at(const std::string& step) {
  const std::scoped_lock held(lock_);
  const auto now = Clock::now();
  if (now - told_ < every_) {
    return;
  }
  told_ = now;
  std::cerr << command_ << ": " << step << std::endl;
}

}  // namespace kolsky::cli
