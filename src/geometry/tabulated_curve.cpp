#include "geometry/tabulated_curve.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "input/units.hpp"
#include "input/wording.hpp"

namespace stirsph {
namespace {

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> result;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) result.emplace_back(input::trimmed(cell));
  if (!line.empty() && line.back() == ',') result.emplace_back();
  return result;
}

/// si = offset + scale * number
struct Conversion {
  double scale = 1, offset = 0;
};

struct Column {
  std::string name, unit;
};

Column parse_column(const std::string& header, const std::string& where) {
  const auto open = header.find('['), close = header.rfind(']');
  if (open == std::string::npos || close == std::string::npos || close < open)
    throw InputError(where + ": the column \"" + header + "\" has no unit. Write name [unit], for instance time [s]");
  return {std::string(input::trimmed(header.substr(0, open))),
          std::string(input::trimmed(header.substr(open + 1, close - open - 1)))};
}

Conversion conversion(const Column& column, const std::string& si_unit, const std::string& where) {
  const std::string unit = column.unit.empty() ? "1" : column.unit;
  try {
    const double offset = input::to_si("0 " + unit, si_unit);
    return {input::to_si("1 " + unit, si_unit) - offset, offset};
  } catch (const input::UnitError& wrong) {
    throw InputError(where + " column " + column.name + ": " + wrong.what());
  }
}

double number(const std::string& cell, const std::string& where, const std::string& column) {
  double value = 0;
  const auto [end, status] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (status != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value))
    throw InputError(where + " " + column + " = \"" + cell + "\": not a number. Allowed: numbers with a decimal point");
  return value;
}

}  // namespace

TabulatedCurve::TabulatedCurve(std::vector<double> times, std::vector<double> values, Outside outside, std::string name)
    : times_(std::move(times)), values_(std::move(values)), outside_(outside), name_(std::move(name)) {
  if (times_.empty() || times_.size() != values_.size())
    throw InputError(name_ + ": a curve needs as many values as times, at least one");
  for (std::size_t i = 1; i < times_.size(); ++i)
    if (!(times_[i] > times_[i - 1]))
      throw InputError(fmt::format("{}: time {} s follows {} s. Times must increase", name_, times_[i], times_[i - 1]));
}

TabulatedCurve TabulatedCurve::read_csv(const std::string& path, const std::string& value_unit,
                                        const std::string& wanted, Outside outside) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot read the table. Check the name and the permissions");
  std::vector<double> times, values;
  std::vector<Column> columns;
  std::size_t time_column = 0, value_column = 0;
  Conversion to_seconds, to_value;
  std::string line;
  for (int line_number = 1; std::getline(file, line); ++line_number) {
    if (line_number == 1 && line.rfind("\xEF\xBB\xBF", 0) == 0) line.erase(0, 3);  // spreadsheets mark UTF-8 so
    line = std::string(input::trimmed(line));
    if (line.empty() || line.front() == '#') continue;
    const std::string where = path + ":" + std::to_string(line_number);
    const auto row = cells(line);
    if (columns.empty()) {
      std::vector<std::string> names;
      for (const auto& cell : row) {
        columns.push_back(parse_column(cell, where));
        names.push_back(columns.back().name);
      }
      const auto index_of = [&](const std::string& name) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
          throw InputError(where + ": no column \"" + name + "\". Known: " + input::joined(names) + "." +
                           input::did_you_mean(name, names));
        return static_cast<std::size_t>(found - names.begin());
      };
      time_column = index_of("time");
      if (!wanted.empty()) {
        value_column = index_of(wanted);
      } else if (columns.size() == 2) {
        value_column = 1 - time_column;
      } else {
        throw InputError(where + ": the table has " + std::to_string(columns.size()) +
                         " columns. Say which one to take. Known: " + input::joined(names));
      }
      to_seconds = conversion(columns[time_column], "s", where);
      to_value = conversion(columns[value_column], value_unit, where);
      continue;
    }
    if (row.size() != columns.size())
      throw InputError(where + ": " + std::to_string(row.size()) + " cells where the header names " +
                       std::to_string(columns.size()));
    times.push_back(to_seconds.offset + to_seconds.scale * number(row[time_column], where, "time"));
    values.push_back(to_value.offset + to_value.scale * number(row[value_column], where, columns[value_column].name));
    if (times.size() > 1 && !(times.back() > times[times.size() - 2]))
      throw InputError(fmt::format("{} time = {} s: not later than the line before ({} s). Times must increase", where,
                                   times.back(), times[times.size() - 2]));
  }
  if (times.empty())
    throw InputError(path +
                     ": the table is empty. Write a header such as \"time [s], position [mm]\" and rows of numbers");
  return TabulatedCurve(std::move(times), std::move(values), outside, path);
}

void TabulatedCurve::check_inside(double time) const {
  if (outside_ == Outside::Refuse && (time < times_.front() || time > times_.back()))
    throw InputError(
        fmt::format("{}: asked at {} s, but covers {} s to {} s only. Extend the table or end the run earlier", name_,
                    time, times_.front(), times_.back()));
}

double TabulatedCurve::value(double time) const {
  check_inside(time);
  if (time <= times_.front()) return values_.front();
  if (time >= times_.back()) return values_.back();
  const std::size_t i = std::upper_bound(times_.begin(), times_.end(), time) - times_.begin();
  const double fraction = (time - times_[i - 1]) / (times_[i] - times_[i - 1]);
  return values_[i - 1] + fraction * (values_[i] - values_[i - 1]);
}

double TabulatedCurve::slope(double time) const {
  check_inside(time);
  if (time < times_.front() || time >= times_.back()) return 0;
  const std::size_t i = std::upper_bound(times_.begin(), times_.end(), time) - times_.begin();
  return (values_[i] - values_[i - 1]) / (times_[i] - times_[i - 1]);
}

}  // namespace stirsph
