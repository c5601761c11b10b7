/// Measured or prescribed curves, such as the position of the tool over time.
#pragma once

#include <string>
#include <vector>

namespace stirsph {

/// A piecewise linear function of time through given points.
class TabulatedCurve {
 public:
  /// What happens before the first and after the last time: keep the end value, or stop with an InputError.
  enum class Outside { Hold, Refuse };

  /// `times` [s] strictly increasing, at least one. Throws InputError otherwise; `name` stands in messages.
  TabulatedCurve(std::vector<double> times, std::vector<double> values, Outside outside = Outside::Hold,
                 std::string name = "curve");

  /// Reads a CSV file whose header names each column with its unit, `time [s], position [mm]`. Empty lines and lines
  /// that begin with # are skipped. The column called "time" is converted to s, the value column to `value_unit`.
  /// `column` picks the value column; it may be empty when there is only one. Throws InputError with file and line.
  static TabulatedCurve read_csv(const std::string& path, const std::string& value_unit, const std::string& column = "",
                                 Outside outside = Outside::Hold);

  double value(double time) const;  ///< in the unit of the values
  /// Per second; at a point the slope of the piece that follows. 0 beyond the ends.
  double slope(double time) const;
  double first_time() const { return times_.front(); }  ///< s
  double last_time() const { return times_.back(); }    ///< s
  const std::vector<double>& times() const { return times_; }
  const std::vector<double>& values() const { return values_; }

 private:
  void check_inside(double time) const;

  std::vector<double> times_, values_;
  Outside outside_;
  std::string name_;
};

}  // namespace stirsph
