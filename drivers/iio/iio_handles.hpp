#pragma once

#include <iio.h>

#include <memory>

#include "drivers/iio/sigpipe_blocked.hpp"

namespace kolsky {

struct ContextDestroyer {
  void operator()(iio_context* context) const noexcept {
    const SigpipeBlocked guard;
    iio_context_destroy(context);
  }
};
using ContextHandle = std::unique_ptr<iio_context, ContextDestroyer>;

/// Cancels first: a cancelled buffer is dropped without asking the server, which may no longer
/// answer.
struct BufferDestroyer {
  void operator()(iio_buffer* buffer) const noexcept {
    const SigpipeBlocked guard;
    iio_buffer_cancel(buffer);
    iio_buffer_destroy(buffer);
  }
};
using BufferHandle = std::unique_ptr<iio_buffer, BufferDestroyer>;

}  // namespace kolsky
