#pragma once

#include <string>

#include "drivers/files/store/catalogue.hpp"
#include "processing/base/shot.hpp"
#include "processing/reduction/reducer.hpp"

namespace kolsky {

/// Reduces a shot as is filed with it: what `kolsky reduce` does with its capture.
/// @throws InputError, as Reducer
[[nodiscard]] Reduction reduce_as_filed(Reducer& reducer, const Shot& shot);

/// Reduces likewise what can be reduced. A shot of a bench that has nothing to reduce (a bar to
/// characterise) gives no histories, and the reason; so does one on which the reduction fails
/// unforeseen, since the shots to come need the thread that reduces.
[[nodiscard]] Reduction reduce_or_say_why(Reducer& reducer, const Shot& shot);

/// A shot's row in the catalogue. @param capture  file name inside store/shots
[[nodiscard]] CatalogueEntry summarise(const Shot& shot, const Reduction& reduction,
                                       const std::string& capture);

}  // namespace kolsky
