/// Small helpers for messages and for written numbers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stirsph::input {

std::string_view trimmed(std::string_view text);

/// The shortest text that reads back to the same double.
std::string shortest(double value);

/// The same as a TOML float: 3 -> "3.0", infinity -> "inf".
std::string toml_real(double value);

/// A TOML basic string with quotes and escapes.
std::string in_quotes(std::string_view text);

/// a, b, c
std::string joined(const std::vector<std::string>& names);

/// The name closest to `wrong` by edit distance, or "" when none is close.
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names);

/// " Did you mean "x"?" or "".
std::string did_you_mean(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace stirsph::input
