#pragma once

#include <string>

#include "drivers/iio/iio_handles.hpp"

namespace kolsky {

/// Refuses what libiio would take for something else, crash on or search the network for: no
/// scheme, no host, a port out of range, a backend this libiio lacks, an XML description (it holds
/// no samples).
/// @throws InputError
void check_uri(const std::string& uri);

/// A context from a private, writable copy of the URI: libiio 0.24 cuts the port off in place, in
/// the caller's memory. A second context to the same device comes from the URI again, never from
/// iio_context_clone, which forgets the port. Its time-outs are short. @pre check_uri(uri)
/// @throws InputError
[[nodiscard]] ContextHandle open_context(const std::string& uri);

/// A negative errno in words.
[[nodiscard]] std::string error_text(long negative_errno);

}  // namespace kolsky
