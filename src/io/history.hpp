/// The time series of a run: history.csv, one row per output time, columns and units in its header.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace stirsph {

struct HistoryColumn {
  std::string name;  ///< for example "tool.force_z"
  std::string unit;  ///< SI, "1" when dimensionless
};

/// Only the root writes: other ranks pass `writes` = false and every call does nothing. Not collective; a failure is an
/// IoError on the root that the caller passes on with Comm::together.
class History {
 public:
  History() = default;

  /// Begins a new file with the columns `time [s]` and then those given.
  static History begin(bool writes, const std::string& path, const std::vector<HistoryColumn>& columns);
  /// Continues the file of an earlier run: checks that its columns are these, drops rows later than `time` [s] (rows
  /// the restarted run will write again) and appends. A missing file is begun anew.
  static History resume(bool writes, const std::string& path, const std::vector<HistoryColumn>& columns, double time);

  /// Appends the values, one or more rows of this time, and hands them to the system at once, so that they can be read
  /// while the run goes on.
  void write(double time, const std::vector<double>& values);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void open(const std::string& path, const char* mode);
  void put(const std::string& text);

  std::string path_;
  std::size_t columns_ = 0;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace stirsph
