/// The checked values of one table: what a Parameters object points to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "input/parameters.hpp"

namespace stirsph::input {

struct Parameters::Node {
  using NodePointer = std::shared_ptr<const Node>;
  struct Value {
    std::string where;  ///< file:line
    std::string shown;  ///< as the user wrote it, for messages
    bool from_default = false;
    std::variant<double, std::vector<double>, std::int64_t, bool, std::string, std::vector<std::string>, Expression,
                 NodePointer, std::vector<NodePointer>>
        content;
  };

  Schema schema;     ///< the declared keys; of a variant, the selector and the chosen alternative's keys
  std::string path;  ///< "body[1].shape", empty at the top
  std::string where;
  std::string folder;
  std::map<std::string, Value, std::less<>> values;  ///< keys that are absent have no element

  std::string path_of(std::string_view key) const {
    if (key.empty()) return path;
    return path.empty() ? std::string(key) : path + "." + std::string(key);
  }
  /// Where a file named in this table lies.
  std::filesystem::path beside(const std::string& file) const {
    return (std::filesystem::path(folder) / file).lexically_normal();  // an absolute name replaces the folder
  }
};

/// The schema of one alternative of a variant: its selector as first key, then its own keys.
Schema alternative_schema(const Entry& variant, const std::string& name, const Schema& alternative);

/// "> 0 m", ">= 0 m and <= 1 m"; empty when any value is allowed.
std::string allowed_range(const Entry& entry);

/// What a value of this entry looks like: `"1 m"`, `3`, `"cubic"`.
std::string example_value(const Entry& entry);

}  // namespace stirsph::input
