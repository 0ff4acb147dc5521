#pragma once

#include <string>

#include "drivers/files/catalogue.hpp"
#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// A shot's row in the catalogue. @param capture  file name inside store/shots
[[nodiscard]] CatalogueEntry summarise(const Shot& shot, const Reduction& reduction,
                                       const std::string& capture);

}  // namespace kolsky
