#include "input/parameters.hpp"

#include <filesystem>
#include <system_error>

#include "base/error.hpp"
#include "input/node.hpp"

namespace stirsph::input {
namespace {

using Node = Parameters::Node;
using Type = Entry::Type;

[[noreturn]] void misuse(const Node& node, std::string_view key, const std::string& what) {
  throw Error(ExitCode::Internal, node.where + " " + node.path_of(key) + ": the code " + what);
}

const Node::Value* find(const Node& node, std::string_view key) {
  const auto found = node.values.find(key);
  return found == node.values.end() ? nullptr : &found->second;
}

/// The content of a key as T; misuse of the declaration is a bug in the code, not in the input.
template <class T>
const T& content(const Node& node, std::string_view key) {
  if (!node.schema.find(key)) misuse(node, key, "asks for a key that is not declared");
  const Node::Value* value = find(node, key);
  if (!value) misuse(node, key, "asks for an optional key that is absent without has()");
  const T* typed = std::get_if<T>(&value->content);
  if (!typed) misuse(node, key, "asks for another type than declared");
  return *typed;
}

}  // namespace

bool Parameters::has(std::string_view key) const {
  if (!node_->schema.find(key)) misuse(*node_, key, "asks for a key that is not declared");
  return find(*node_, key) != nullptr;
}

double Parameters::real(std::string_view key) const { return content<double>(*node_, key); }
std::vector<double> Parameters::reals(std::string_view key) const { return content<std::vector<double>>(*node_, key); }

Vec3 Parameters::vector(std::string_view key) const {
  const auto& values = content<std::vector<double>>(*node_, key);
  if (values.size() != 2 && values.size() != 3)
    fail(key, std::to_string(values.size()) + " components. Allowed: 2 or 3 (x, y and z)");
  return {values[0], values[1], values.size() == 3 ? values[2] : 0.0};
}

std::int64_t Parameters::integer(std::string_view key) const { return content<std::int64_t>(*node_, key); }
bool Parameters::boolean(std::string_view key) const { return content<bool>(*node_, key); }
const std::string& Parameters::text(std::string_view key) const { return content<std::string>(*node_, key); }
std::vector<std::string> Parameters::texts(std::string_view key) const {
  return content<std::vector<std::string>>(*node_, key);
}
std::string Parameters::file(std::string_view key) const {
  const std::filesystem::path path = node_->beside(text(key));
  std::error_code too_long;  // or another reason why the name cannot even be looked up
  if (!std::filesystem::is_regular_file(path, too_long))
    fail(key, "there is no such file. Looked for " + path.string() +
                  "; a relative name is taken from the folder of the input file");
  return path.string();
}

Expression Parameters::expression(std::string_view key) const { return content<Expression>(*node_, key); }
Parameters Parameters::table(std::string_view key) const { return Parameters(content<Node::NodePointer>(*node_, key)); }

std::vector<Parameters> Parameters::tables(std::string_view key) const {
  const Entry* entry = node_->schema.find(key);
  // An optional list that was not given is an empty list.
  if (entry && (entry->type == Type::Tables || entry->type == Type::Variants) && !find(*node_, key)) return {};
  std::vector<Parameters> result;
  for (const auto& node : content<std::vector<Node::NodePointer>>(*node_, key)) result.emplace_back(node);
  return result;
}

std::string Parameters::where(std::string_view key) const {
  const Node::Value* value = key.empty() ? nullptr : find(*node_, key);
  return value ? value->where : node_->where;
}

void Parameters::fail(std::string_view key, const std::string& message) const {
  const Node::Value* value = key.empty() ? nullptr : find(*node_, key);
  const std::string path = node_->path_of(key);
  throw InputError(where(key) + (path.empty() ? "" : " " + path) +
                   (value && !value->from_default ? " = " + value->shown : "") + ": " + message);
}

std::string Parameters::folder() const { return node_->folder; }

}  // namespace stirsph::input
