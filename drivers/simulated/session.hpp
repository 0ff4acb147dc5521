#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/simulated/connection.hpp"
#include "drivers/simulated/iiod_command.hpp"
#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

/// Answers one client's commands until it leaves.
class Session {
 public:
  /// Closes every connection and those to come for a duration of the converter's time, in seconds.
  using Drop = std::function<void(double)>;

  Session(Connection& connection, SimulatedAdc& adc, Drop drop);

  void run();

 private:
  /// How a wait or a fault leaves the reply.
  enum class Next {
    go_on,
    refuse,  ///< with ETIMEDOUT
    leave,   ///< the connection is over
  };

  /// A read of the buffer while it is answered.
  struct Reply {
    std::size_t bytes_left = 0;
    std::size_t most_samples = 0;  ///< a script may end it early
    bool started = false;
  };

  // Each of these answers a command, or a part of it, and returns whether the connection goes on.
  [[nodiscard]] bool answer(const IiodCommand& command);
  [[nodiscard]] bool reply(long code);
  [[nodiscard]] bool reply_text(const std::string& text, bool terminated);
  [[nodiscard]] bool refuse_unknown_device(const IiodCommand& command);
  [[nodiscard]] bool read_attribute(const IiodCommand& command);
  [[nodiscard]] bool write_attribute(const IiodCommand& command);
  [[nodiscard]] bool open(const IiodCommand& command);
  [[nodiscard]] bool close();
  [[nodiscard]] bool read_buffer(const IiodCommand& command);
  [[nodiscard]] bool send_blocks(Reply& answered);
  [[nodiscard]] bool send_samples(std::size_t samples, bool with_mask);

  [[nodiscard]] Next await_block();
  [[nodiscard]] Next act(const Fault& fault, Reply& answered);
  [[nodiscard]] Next pause(double seconds);

  Connection& connection_;
  SimulatedAdc& adc_;
  Drop drop_;
  std::unique_ptr<AdcStream> stream_;
  std::uint32_t register_address_ = 0;
  std::vector<std::byte> outgoing_;
};

}  // namespace kolsky
