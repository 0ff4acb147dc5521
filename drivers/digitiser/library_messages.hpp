#pragma once

namespace kolsky {

/// libiio tells stderr of every failure before it returns the error that the caller then reports,
/// and has no switch for it. From now on what goes through `stderr` of the C library passes but
/// for those messages. Once, before other threads begin.
void leave_out_libiio_messages();

}  // namespace kolsky
