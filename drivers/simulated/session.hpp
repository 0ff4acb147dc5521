#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "drivers/simulated/connection.hpp"
#include "drivers/simulated/iiod_command.hpp"
#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

/// Answers one client's commands until it leaves.
class Session {
 public:
  Session(Connection& connection, SimulatedAdc& adc);

  void run();

 private:
  enum class Awaited { block, timeout, over };

  /// Each answers one command. @return false if the connection is over
  [[nodiscard]] bool answer(const IiodCommand& command);
  [[nodiscard]] bool reply(long code);
  [[nodiscard]] bool reply_text(const std::string& text, bool terminated);
  [[nodiscard]] bool read_attribute(const IiodCommand& command);
  [[nodiscard]] bool write_attribute(const IiodCommand& command);
  [[nodiscard]] bool open(const IiodCommand& command);
  [[nodiscard]] bool close(const IiodCommand& command);
  [[nodiscard]] bool read_buffer(const IiodCommand& command);
  [[nodiscard]] Awaited await_block();
  [[nodiscard]] bool send_samples(std::size_t samples, bool with_mask);

  Connection& connection_;
  SimulatedAdc& adc_;
  std::unique_ptr<AdcStream> stream_;
  std::uint32_t register_address_ = 0;
  std::vector<std::byte> scans_;
};

}  // namespace kolsky
