/// Writes the values in force, defaults included, as TOML that reads back to the same values.
#include "base/error.hpp"
#include "input/node.hpp"
#include "input/wording.hpp"

namespace stirsph::input {
namespace {

using Node = Parameters::Node;

std::string quantity(double value, const std::string& unit) {
  return unit == "1" ? toml_real(value) : in_quotes(shortest(value) + " " + unit);
}

template <class T, class Write>
std::string list(const std::vector<T>& values, Write write) {
  std::string text;
  for (const auto& value : values) text += (text.empty() ? "" : ", ") + write(value);
  return "[" + text + "]";
}

/// The value of a key that fits on one line.
std::string written(const Node& node, const Entry& entry, const Node::Value& value) {
  if (entry.is_file)
    return in_quotes(std::filesystem::absolute(node.beside(std::get<std::string>(value.content))).string());
  const auto& unit = entry.si_unit;
  struct Writer {
    const std::string& unit;
    std::string operator()(double x) const { return quantity(x, unit); }
    std::string operator()(const std::vector<double>& xs) const {
      return list(xs, [this](double x) { return quantity(x, unit); });
    }
    std::string operator()(std::int64_t x) const { return std::to_string(x); }
    std::string operator()(bool x) const { return x ? "true" : "false"; }
    std::string operator()(const std::string& x) const { return in_quotes(x); }
    std::string operator()(const std::vector<std::string>& xs) const {
      return list(xs, [](const std::string& x) { return in_quotes(x); });
    }
    std::string operator()(const Expression& x) const {
      return x.is_constant() ? quantity(x({}), unit) : in_quotes(x.text());
    }
    std::string operator()(const Node::NodePointer&) const { return {}; }
    std::string operator()(const std::vector<Node::NodePointer>&) const { return {}; }
  };
  return std::visit(Writer{unit}, value.content);
}

/// Text for a comment: one line.
std::string remark(std::string text) {
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return text;
}

/// `name` is the dotted header of this table, without indices: TOML finds the element of a list by order.
void write(const Node& node, const std::string& name, std::string& out) {
  for (const auto& entry : node.schema.entries()) {
    const auto found = node.values.find(entry->key);
    if (found == node.values.end()) {
      if (entry->type != Entry::Type::Table && entry->type != Entry::Type::Variant)
        out += "# " + entry->key + ": not given, " + remark(entry->doc) + "\n";
      continue;
    }
    const Node::Value& value = found->second;
    const std::string text = written(node, *entry, value);
    if (text.empty()) continue;
    out += entry->key + " = " + text + "  # " + remark(entry->doc) + (value.from_default ? " (default)" : "") + "\n";
  }
  const auto header = [&](const Entry& entry, const char* open, const char* close) {
    const std::string full = name.empty() ? entry.key : name + "." + entry.key;
    out += std::string(out.empty() ? "" : "\n") + open + full + close;
    if (!entry.doc.empty()) out += "  # " + remark(entry.doc);
    out += "\n";
    return full;
  };
  for (const auto& entry : node.schema.entries()) {
    const auto found = node.values.find(entry->key);
    if (found == node.values.end()) continue;
    if (const auto* table = std::get_if<Node::NodePointer>(&found->second.content)) {
      const std::string full = header(*entry, "[", "]");
      write(**table, full, out);
    } else if (const auto* tables = std::get_if<std::vector<Node::NodePointer>>(&found->second.content)) {
      for (const auto& element : *tables) {
        const std::string full = header(*entry, "[[", "]]");
        write(*element, full, out);
      }
    }
  }
}

}  // namespace

std::string Parameters::as_toml() const {
  std::string out;
  write(*node_, "", out);
  return out;
}

}  // namespace stirsph::input
