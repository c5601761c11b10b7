#include "io/history.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "base/error.hpp"
#include "base/log.hpp"
#include "io/files.hpp"

namespace stirsph {
namespace {

std::string header_of(const std::vector<HistoryColumn>& columns) {
  std::string header = "time [s]";
  for (const HistoryColumn& column : columns) header += "," + column.name + " [" + column.unit + "]";
  return header;
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> parts;
  std::istringstream stream(line);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

/// Says in which columns a file and a scene differ; a row under the wrong heading would be worse than a stop.
void compare_headers(const std::string& path, const std::string& found, const std::string& expected) {
  if (found == expected) return;
  const std::vector<std::string> in_file = split(found), in_scene = split(expected);
  std::string difference;
  const auto list_missing = [&](const auto& from, const auto& in, const char* what) {
    for (const std::string& name : from)
      if (std::find(in.begin(), in.end(), name) == in.end()) difference += std::string(what) + "'" + name + "'";
  };
  list_missing(in_file, in_scene, "; only in the file: ");
  list_missing(in_scene, in_file, "; only in this scene: ");
  if (difference.empty()) difference = "; they are in another order";
  throw IoError("cannot continue " + path + ": its columns are not those of this scene" + difference +
                "; restart with the scene that wrote it or into another output folder");
}

}  // namespace

void History::open(const std::string& path, const char* mode) {
  path_ = path;
  file_.reset(std::fopen(path.c_str(), mode));
  if (!file_) throw_write_error("write", path, errno);
}

void History::put(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size() || std::fflush(file_.get()) != 0)
    throw_write_error("write", path_, errno);
}

History History::begin(bool writes, const std::string& path, const std::vector<HistoryColumn>& columns) {
  History history;
  history.columns_ = columns.size();
  if (!writes) return history;
  history.open(path, "w");
  history.put(header_of(columns) + "\n");
  return history;
}

History History::resume(bool writes, const std::string& path, const std::vector<HistoryColumn>& columns, double time) {
  if (!writes) return begin(false, path, columns);
  std::ifstream earlier(path, std::ios::binary);
  if (!earlier) {
    log::warning("there is no " + path + " to continue; it begins at the restart");
    return begin(true, path, columns);
  }
  std::ostringstream whole;
  whole << earlier.rdbuf();
  const std::string text = whole.str();
  const std::string header = header_of(columns);
  std::string kept;
  // Times are written with 15 digits; the last one may have been rounded up.
  const double last = time + 1e-14 * std::abs(time);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) break;  // a row cut off when the run was killed
    const std::string line = text.substr(begin, end - begin);
    if (begin == 0)
      compare_headers(path, line, header);
    else if (std::strtod(line.c_str(), nullptr) > last)
      break;
    kept += line + "\n";
    begin = end + 1;
  }
  if (kept.empty()) kept = header + "\n";
  write_text_file(path, kept);
  History history;
  history.columns_ = columns.size();
  history.open(path, "a");
  return history;
}

void History::write(double time, const std::vector<double>& values) {
  if (!file_) return;
  STIRSPH_EXPECT(values.size() % columns_ == 0, "a row has one value per column");
  char number[40];
  std::snprintf(number, sizeof number, "%.15g", time);
  const std::string head = number;
  std::string rows;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k % columns_ == 0) rows += head;
    std::snprintf(number, sizeof number, ",%.10g", values[k]);
    rows += number;
    if (k % columns_ == columns_ - 1) rows += "\n";
  }
  put(rows);
}

}  // namespace stirsph
