#include "input/units.hpp"

#include <udunits2.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

#include "base/error.hpp"
#include "input/wording.hpp"

namespace stirsph::input {
namespace {

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;
struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};

ut_system* unit_system() {
  static ut_system* const system = [] {
    ut_set_error_message_handler(ut_ignore);
    ut_system* read = ut_read_xml(nullptr);
    if (!read)
      throw Error(ExitCode::Internal,
                  "cannot read the unit database of udunits2: install udunits-bin or set UDUNITS2_XML_PATH");
    // The database writes angles in full only.
    for (const auto& [symbol, name] : {std::pair{"deg", "degree"}, std::pair{"rev", "turn"}}) {
      const Unit unit(ut_parse(read, name, UT_UTF8));
      if (unit) ut_map_symbol_to_unit(symbol, UT_UTF8, unit.get());
    }
    return read;
  }();
  return system;
}

Unit parse_unit(const std::string& text) { return Unit(ut_parse(unit_system(), text.c_str(), UT_UTF8)); }

struct Split {
  double number;
  std::string unit;
};

/// "12.5 mm" -> 12.5, "mm"; nothing when it does not start with a number.
std::optional<Split> split(std::string_view quantity) {
  quantity = trimmed(quantity);
  const char* first = quantity.data();
  const char* const last = first + quantity.size();
  if (first != last && *first == '+') ++first;
  Split result{};
  const auto [end, status] = std::from_chars(first, last, result.number);
  if (status != std::errc{}) return {};
  result.unit = trimmed(std::string_view(end, last - end));
  return result;
}

/// Power of the radian in a unit, as udunits2 writes its definition ("0.1047 s-1.rad").
std::string angle_power(const Unit& unit) {
  char text[512];
  const int length = ut_format(unit.get(), text, sizeof text, UT_ASCII | UT_DEFINITION);
  if (length < 0 || length >= static_cast<int>(sizeof text)) return {};
  const std::string_view definition(text, length);
  const auto at = definition.find("rad");
  if (at == std::string_view::npos) return {};
  return std::string(definition.substr(at, definition.find_first_of(" .", at) - at));
}

std::string example(double number, const std::string& unit) { return in_quotes(shortest(number) + " " + unit); }

}  // namespace

double to_si(std::string_view quantity, const std::string& si_unit, bool is_difference) {
  const auto parts = split(quantity);
  const bool plain = si_unit == "1";
  const std::string wanted = plain ? "a plain number" : "a quantity in " + si_unit;
  if (!parts)
    throw UnitError("not a quantity. Expected: " + wanted + ". Write for instance " +
                    (plain ? "0.5" : example(1, si_unit)));
  const auto& [number, unit] = *parts;
  if (std::isnan(number)) throw UnitError("not a number. Expected: " + wanted);
  if (unit.empty()) {
    if (plain) return number;
    throw UnitError("has no unit. Expected: " + wanted + ". If SI is meant, write " + example(number, si_unit));
  }
  if (unit == si_unit) return number;  // exactly, so that the effective input reads back to the same bits
  const Unit from = parse_unit(unit);
  if (!from) throw UnitError("\"" + unit + "\" is not a known unit. Expected: " + wanted);
  const Unit to = parse_unit(si_unit);
  if (!to) throw Error(ExitCode::Internal, "the schema declares \"" + si_unit + "\", which is not a unit");
  const bool same_angle = angle_power(from) == angle_power(to);
  if (!same_angle || !ut_are_convertible(from.get(), to.get())) {
    std::string hint;
    if (!same_angle && ut_are_convertible(from.get(), to.get()))
      hint = angle_power(to).empty() ? " (an angle is not a plain number here)" : " (say the angle: rad/s, rpm, deg)";
    throw UnitError("the unit \"" + unit + "\" does not convert to " + (plain ? "a plain number" : si_unit) + hint +
                    ". Expected: " + wanted);
  }
  const std::unique_ptr<cv_converter, FreeConverter> converter(ut_get_converter(from.get(), to.get()));
  const double zero = cv_convert_double(converter.get(), 0.0);
  if (zero != 0) return cv_convert_double(converter.get(), number) - (is_difference ? zero : 0.0);
  // "12.5 mm" is 12.5/1000, correctly rounded; 12.5*0.001 may miss the nearest double.
  const double scale = cv_convert_double(converter.get(), 1.0), inverse = std::round(1 / scale);
  if (scale < 1 && std::abs(scale * inverse - 1) < 1e-14) return number / inverse;
  return cv_convert_double(converter.get(), number);
}

bool is_quantity(std::string_view text) {
  const auto parts = split(text);
  return parts && (parts->unit.empty() || parse_unit(parts->unit));
}

void check_unit(const std::string& si_unit) {
  if (!parse_unit(si_unit)) throw Error(ExitCode::Internal, "the schema declares \"" + si_unit + "\", not a unit");
}

}  // namespace stirsph::input
