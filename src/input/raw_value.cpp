#include "input/raw_value.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <toml.hpp>
#include <utility>

#include "base/error.hpp"
#include "input/wording.hpp"

namespace stirsph::input {
namespace {

RawValue converted(const toml::value& value, const std::string& file, int line_of_parent) {
  RawValue raw;
  raw.file = file;
  raw.line = static_cast<int>(value.location().line());
  if (raw.line == 0) raw.line = line_of_parent;  // tables that only exist through a dotted name
  switch (value.type()) {
    case toml::value_t::boolean:
      raw.kind = RawValue::Kind::Boolean;
      raw.boolean = value.as_boolean();
      break;
    case toml::value_t::integer:
      raw.kind = RawValue::Kind::Integer;
      raw.integer = value.as_integer();
      break;
    case toml::value_t::floating:
      raw.kind = RawValue::Kind::Real;
      raw.real = value.as_floating();
      break;
    case toml::value_t::string:
      raw.kind = RawValue::Kind::String;
      raw.text = value.as_string().str;
      break;
    case toml::value_t::array:
      raw.kind = RawValue::Kind::Array;
      for (const auto& element : value.as_array()) raw.array.push_back(converted(element, file, raw.line));
      break;
    case toml::value_t::table:
      raw.kind = RawValue::Kind::Table;
      for (const auto& [key, member] : value.as_table())
        raw.members.push_back({key, converted(member, file, raw.line)});
      // toml11 keeps tables unordered; messages and the first error must not depend on a hash.
      std::sort(raw.members.begin(), raw.members.end(), [](const auto& a, const auto& b) {
        return std::pair(a.value.line, a.key) < std::pair(b.value.line, b.key);
      });
      break;
    default: {
      raw.kind = RawValue::Kind::Date;
      std::ostringstream text;
      text << value;
      raw.text = text.str();
    }
  }
  return raw;
}

/// toml11's message without its "[error] toml::parse_table: " prefix and without the colours and frame of the console.
std::string first_line(const std::string& message) {
  std::string line = message.substr(0, message.find('\n'));
  if (line.rfind("[error] ", 0) == 0) line.erase(0, 8);
  if (line.rfind("toml::", 0) == 0) {
    const auto colon = line.find(": ");
    if (colon != std::string::npos) line.erase(0, colon + 2);
  }
  while (!line.empty() && line.back() == '.') line.pop_back();
  return line;
}

std::string line_of(const std::string& text, std::size_t number) {
  std::istringstream lines(text);
  std::string line;
  for (std::size_t i = 0; i < number && std::getline(lines, line); ++i) {
  }
  return std::string(trimmed(line));
}

/// Index of the last character of the string that begins at `begin`, or the length of the text.
std::size_t end_of_string(const std::string& text, std::size_t begin) {
  const char quote = text[begin];
  const std::string three(3, quote);
  const bool multiline = text.compare(begin, 3, three) == 0;
  for (std::size_t i = begin + (multiline ? 3 : 1); i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (!multiline && (text[i] == quote || text[i] == '\n')) {
      return i;
    } else if (multiline && text.compare(i, 3, three) == 0) {
      std::size_t last = i + 2;
      while (last + 1 < text.size() && text[last + 1] == quote) ++last;  // quotes may end a text in quotes
      return last;
    }
  }
  return text.size();
}

/// toml11 reads what is nested by recursion and without a limit: a line of brackets would overrun the stack.
void refuse_deep_nesting(const std::string& text, const std::string& name) {
  constexpr int deepest = 100;
  int depth = 0, dots = 0;  // open brackets, and dots of the present key
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      i = end_of_string(text, i);
    } else if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
      dots = 0;
    } else if (c == '[' || c == '{') {
      ++depth;
      dots = 0;
    } else if (c == ']' || c == '}') {
      depth = std::max(depth - 1, 0);
    } else if (c == '.') {
      ++dots;
    } else if (c == '=' || c == ',' || c == '\n') {
      dots = 0;
    }
    if (depth + dots > deepest)
      throw InputError(name + ":" + std::to_string(1 + std::count(text.begin(), text.begin() + i, '\n')) +
                       ": more than " + std::to_string(deepest) + " tables or lists are nested here");
  }
}

std::vector<std::string> segments(const std::string& path) {
  std::vector<std::string> result(1);
  for (const char c : path) {
    if (c == '.' || c == '[')
      result.emplace_back();
    else if (c != ']')
      result.back() += c;
  }
  for (auto& part : result) part = std::string(trimmed(part));
  return result;
}

}  // namespace

const RawValue* RawValue::find(std::string_view key) const {
  for (const auto& [name, value] : members)
    if (name == key) return &value;
  return nullptr;
}

RawValue* RawValue::find(std::string_view key) { return const_cast<RawValue*>(std::as_const(*this).find(key)); }

std::string RawValue::where() const { return line > 0 ? file + ":" + std::to_string(line) : file; }

std::string RawValue::shown() const {
  switch (kind) {
    case Kind::Boolean:
      return boolean ? "true" : "false";
    case Kind::Integer:
      return std::to_string(integer);
    case Kind::Real:
      return toml_real(real);
    case Kind::String:
      return in_quotes(text);
    case Kind::Date:
      return text;
    case Kind::Table:
      return "{...}";
    case Kind::Array: {
      std::string result = "[";
      for (std::size_t i = 0; i < array.size() && i < 6; ++i) result += (i ? ", " : "") + array[i].shown();
      return result + (array.size() > 6 ? ", ...]" : "]");
    }
  }
  return {};
}

std::string_view RawValue::kind_name() const {
  switch (kind) {
    case Kind::Boolean:
      return "true or false";
    case Kind::Integer:
      return "an integer";
    case Kind::Real:
      return "a number";
    case Kind::String:
      return "a text";
    case Kind::Date:
      return "a date";
    case Kind::Table:
      return "a table";
    case Kind::Array:
      return "a list";
  }
  return {};
}

RawValue read_toml(const std::string& text, const std::string& name) {
  refuse_deep_nesting(text, name);
  // toml11 3.7 reads "a = 1" at the end of a text without a final newline, but its frame printer then runs one past it.
  std::istringstream stream(text + "\n");
  try {
    RawValue root = converted(toml::parse(stream, name), name, 0);
    root.line = 0;
    return root;
  } catch (const toml::exception& wrong) {
    const auto line = wrong.location().line();
    const std::string shown = line_of(text, line);
    throw InputError(name + ":" + std::to_string(line) + ": not valid TOML: " + first_line(wrong.what()) +
                     (shown.empty() ? "" : ". The line is: " + shown));
  } catch (const std::exception& wrong) {
    throw InputError(name + ": not valid TOML: " + first_line(wrong.what()));
  }
}

RawValue read_value(const std::string& text, const std::string& file) {
  RawValue value;
  value.kind = RawValue::Kind::String;
  value.text = text;
  // A line break could smuggle in a second key.
  if (text.find('\n') == std::string::npos) {
    try {
      const RawValue table = read_toml("value = " + text, file);
      if (const RawValue* read = table.find("value"); read && table.members.size() == 1) {
        value = *read;
        const bool scalar = value.kind != RawValue::Kind::Array && value.kind != RawValue::Kind::Table;
        if (scalar && value.kind != RawValue::Kind::String) value.text = text;
      }
    } catch (const InputError&) {  // bare text such as 1500 rpm
    }
  }
  const auto relocate = [&file](auto& self, RawValue& v) -> void {
    v.file = file;
    v.line = 0;
    for (auto& element : v.array) self(self, element);
    for (auto& member : v.members) self(self, member.value);
  };
  relocate(relocate, value);
  return value;
}

void apply_override(RawValue& root, const std::string& assignment) {
  const std::string file = "command line";
  const auto equals = assignment.find('=');
  if (equals == std::string::npos || trimmed(assignment.substr(0, equals)).empty())
    throw InputError(file + ": \"" + assignment + "\" is no override. Write section.key=value");
  const std::string path(trimmed(assignment.substr(0, equals)));
  const auto parts = segments(path);
  RawValue* at = &root;
  std::string so_far;
  for (const auto& part : parts) {
    if (part.empty()) throw InputError(file + " " + path + ": empty name. Write section.key=value");
    if (at->kind == RawValue::Kind::Array) {
      std::size_t index = 0;
      const auto [end, status] = std::from_chars(part.data(), part.data() + part.size(), index);
      if (status != std::errc{} || end != part.data() + part.size() || index >= at->array.size())
        throw InputError(file + " " + path + ": \"" + part + "\" is no index of " + so_far + ". Allowed: 0 to " +
                         std::to_string(static_cast<long>(at->array.size()) - 1) + " (the list has " +
                         std::to_string(at->array.size()) + " elements)");
      at = &at->array[index];
    } else if (at->kind == RawValue::Kind::Table) {
      RawValue* next = at->find(part);
      if (!next) {
        RawValue created;
        created.file = file;
        at->members.push_back({part, created});
        next = &at->members.back().value;
      }
      at = next;
    } else {
      throw InputError(file + " " + path + ": " + so_far + " is " + std::string(at->kind_name()) + " (" + at->shown() +
                       "), not a table, and has no key \"" + part + "\"");
    }
    so_far += (so_far.empty() ? "" : ".") + part;
  }
  *at = read_value(std::string(trimmed(assignment.substr(equals + 1))), file);
}

}  // namespace stirsph::input
