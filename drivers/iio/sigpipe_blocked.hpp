#pragma once

#include <csignal>

namespace kolsky {

/// While it lives, a write to a connection that the peer has dropped does not kill the process:
/// SIGPIPE is blocked in this thread, and one that libiio's sends raised meanwhile is taken back.
/// Programs that ignore SIGPIPE lose nothing by it; those that embed the driver need not change a
/// process-wide setting.
class SigpipeBlocked {
 public:
  SigpipeBlocked() noexcept;
  ~SigpipeBlocked();
  SigpipeBlocked(const SigpipeBlocked&) = delete;
  SigpipeBlocked& operator=(const SigpipeBlocked&) = delete;

 private:
  sigset_t previous_;
  bool was_pending_;
};

}  // namespace kolsky
