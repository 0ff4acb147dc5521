#pragma once

#include <string>
#include <vector>

namespace kolsky::cli {

/// A number that an option holds among others. @param place  the option, for messages
/// @throws InputError
[[nodiscard]] double number_in(const std::string& text, const std::string& place);

/// "0,0.5,2". @throws InputError
[[nodiscard]] std::vector<double> numbers_in(const std::string& list, const std::string& place);

}  // namespace kolsky::cli
