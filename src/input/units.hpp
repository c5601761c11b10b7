/// Quantities with units ("1500 rpm") converted to SI through udunits2.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace stirsph::input {

/// What is wrong with a quantity, without file and key (the caller knows those).
struct UnitError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Converts "12 kN" to `si_unit`. A bare number is accepted only for the unit "1"; "95 percent" is 0.95 there.
/// Angles are not plain numbers here: Hz does not convert to rad/s, although udunits2 alone would let it, because
/// 25 Hz would silently become 25 rad/s. With `is_difference` an offset scale counts its steps: 5 degC -> 5 K.
/// Throws UnitError.
double to_si(std::string_view quantity, const std::string& si_unit, bool is_difference = false);

/// True when `text` is a number, or a number followed by a known unit: a quantity rather than a formula.
bool is_quantity(std::string_view text);

/// Throws Error(Internal) when `si_unit` is not a unit.
void check_unit(const std::string& si_unit);

}  // namespace stirsph::input
