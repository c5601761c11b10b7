/// Checks a TOML tree against its schema and converts every value to SI.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "base/error.hpp"
#include "input/node.hpp"
#include "input/raw_value.hpp"
#include "input/units.hpp"
#include "input/wording.hpp"

namespace stirsph::input {

namespace {
std::string with_unit(double value, const std::string& unit) {
  return shortest(value) + (unit == "1" ? "" : " " + unit);
}
}  // namespace

std::string allowed_range(const Entry& entry) {
  std::string text;
  if (std::isfinite(entry.lowest))
    text = (entry.lowest_excluded ? "> " : ">= ") + with_unit(entry.lowest, entry.si_unit);
  if (std::isfinite(entry.highest))
    text += (text.empty() ? "<= " : " and <= ") + with_unit(entry.highest, entry.si_unit);
  return text;
}

std::string example_value(const Entry& entry) {
  const std::string real = entry.si_unit == "1" ? "1.0" : "\"1 " + entry.si_unit + "\"";
  switch (entry.type) {
    case Entry::Type::Real:
    case Entry::Type::Expression:
      return real;
    case Entry::Type::Reals:
      return "[" + real + ", " + real + "]";
    case Entry::Type::Integer:
      return "1";
    case Entry::Type::Boolean:
      return "true";
    case Entry::Type::Text:
      return "\"text\"";
    case Entry::Type::Texts:
      return "[\"text\"]";
    case Entry::Type::Choice:
      return entry.choices.empty() ? "\"\"" : in_quotes(entry.choices.front());
    case Entry::Type::Table:
    case Entry::Type::Variant:
      return "{ ... }";
    case Entry::Type::Tables:
    case Entry::Type::Variants:
      return "[{ ... }]";
  }
  return {};
}

Schema alternative_schema(const Entry& variant, const std::string& name, const Schema& alternative) {
  Schema schema(alternative.doc);
  std::vector<std::string> names;
  for (const auto& other : variant.alternatives()) names.push_back(other.first);
  schema.choice(variant.selector, names,
                variant.doc + ": " + name + (alternative.doc.empty() ? "" : ", ") + alternative.doc);
  return schema.include(alternative);
}

namespace {

using Node = Parameters::Node;

class Checker {
 public:
  explicit Checker(std::string folder) : folder_(std::move(folder)) {}

  std::shared_ptr<const Node> table(const Schema& schema, const RawValue& raw, const std::string& path) const {
    auto node = std::make_shared<Node>();
    node->schema = schema;
    node->path = path;
    node->where = raw.where();
    node->folder = folder_;
    refuse_unknown(schema, raw, path);
    for (const auto& entry : schema.entries()) {
      const std::string key_path = node->path_of(entry->key);
      if (const RawValue* given = raw.find(entry->key)) {
        node->values.emplace(entry->key, value(*entry, *given, key_path));
      } else if (auto standard = standard_value(*entry, raw, key_path)) {
        standard->from_default = true;
        node->values.emplace(entry->key, std::move(*standard));
      }
    }
    return node;
  }

 private:
  using Value = Node::Value;

  [[noreturn]] static void fail(const RawValue& at, const std::string& path, const std::string& message) {
    throw InputError(at.where() + " " + path + " = " + at.shown() + ": " + message);
  }

  static void refuse_unknown(const Schema& schema, const RawValue& raw, const std::string& path) {
    for (const auto& [key, given] : raw.members) {
      if (schema.find(key)) continue;
      std::vector<std::string> known;
      for (const auto& entry : schema.entries()) known.push_back(entry->key);
      fail(given, path.empty() ? key : path + "." + key,
           "unknown key" + (path.empty() ? std::string() : " in [" + path + "]") + ". Known: " + joined(known) + "." +
               did_you_mean(key, known));
    }
  }

  static std::string allowed_sentence(const Entry& entry) {
    const std::string range = allowed_range(entry);
    return range.empty() ? "" : " Allowed: " + range + ".";
  }

  [[noreturn]] static void wrong_type(const Entry& entry, const RawValue& raw, const std::string& path,
                                      const std::string& expected) {
    fail(raw, path,
         std::string(raw.kind_name()) + " where " + expected + " is expected (" + entry.doc + ")." +
             allowed_sentence(entry) + " Write for instance " + entry.key + " = " + example_value(entry));
  }

  static void check_range(const Entry& entry, double value, const RawValue& raw, const std::string& path) {
    const bool too_low = entry.lowest_excluded ? !(value > entry.lowest) : !(value >= entry.lowest);
    if (!too_low && value <= entry.highest) return;
    const bool converted = raw.kind == RawValue::Kind::String && entry.si_unit != "1";
    fail(raw, path,
         "out of range" + (converted ? " (" + with_unit(value, entry.si_unit) + ")" : std::string()) +
             ". Allowed: " + allowed_range(entry) + ". Meaning: " + entry.doc);
  }

  static double real(const Entry& entry, const RawValue& raw, const std::string& path) {
    const bool plain = entry.si_unit == "1";
    double value = 0;
    if (raw.is_number() && plain) {
      value = raw.number();
      if (std::isnan(value)) fail(raw, path, "not a number. Expected: a plain number (" + entry.doc + ")");
    } else if (raw.is_number()) {
      fail(raw, path,
           "a number without a unit. Expected: a quantity in " + entry.si_unit + " (" + entry.doc +
               "). If SI is meant, write " + entry.key + " = \"" + shortest(raw.number()) + " " + entry.si_unit + "\"");
    } else if (raw.kind == RawValue::Kind::String) {
      try {
        value = to_si(raw.text, entry.si_unit, entry.is_difference);
      } catch (const UnitError& wrong) {
        fail(raw, path, std::string(wrong.what()) + " (" + entry.doc + ")." + allowed_sentence(entry));
      }
    } else {
      wrong_type(entry, raw, path, plain ? "a number" : "a quantity in " + entry.si_unit);
    }
    check_range(entry, value, raw, path);
    return value;
  }

  static void check_count(const Entry& entry, std::size_t count, const RawValue& raw, const std::string& path) {
    if (count >= entry.fewest && count <= entry.most) return;
    std::string allowed = std::to_string(entry.fewest);
    if (entry.most != entry.fewest)
      allowed +=
          entry.most == std::numeric_limits<std::size_t>::max() ? " or more" : " to " + std::to_string(entry.most);
    fail(raw, path, std::to_string(count) + " elements. Allowed: " + allowed + ". Meaning: " + entry.doc);
  }

  static const std::vector<RawValue>& elements(const Entry& entry, const RawValue& raw, const std::string& path) {
    if (raw.kind != RawValue::Kind::Array) wrong_type(entry, raw, path, "a list");
    check_count(entry, raw.array.size(), raw, path);
    return raw.array;
  }

  static std::string indexed(const std::string& path, std::size_t i) { return path + "[" + std::to_string(i) + "]"; }

  static std::string text(const Entry& entry, const RawValue& raw, const std::string& path) {
    const bool bare_override = raw.line == 0 && !raw.text.empty();  // the shell ate the quotes of name="12"
    if (raw.kind != RawValue::Kind::String && !bare_override) wrong_type(entry, raw, path, "a text in quotes");
    return raw.text;
  }

  static std::string choice(const std::vector<std::string>& choices, const RawValue& raw, const std::string& path,
                            const std::string& doc) {
    for (const auto& name : choices)
      if (raw.kind == RawValue::Kind::String && raw.text == name) return name;
    fail(raw, path,
         "no such choice (" + doc + "). Allowed: " + joined(choices) + "." +
             (raw.kind == RawValue::Kind::String ? did_you_mean(raw.text, choices) : ""));
  }

  static std::int64_t integer(const Entry& entry, const RawValue& raw, const std::string& path) {
    std::int64_t value = raw.integer;
    if (raw.kind == RawValue::Kind::Real && raw.real == std::round(raw.real) && std::abs(raw.real) < 9e15)
      value = static_cast<std::int64_t>(raw.real);  // 1e6 for a million steps
    else if (raw.kind != RawValue::Kind::Integer)
      wrong_type(entry, raw, path, "an integer");
    check_range(entry, static_cast<double>(value), raw, path);
    return value;
  }

  static Expression expression(const Entry& entry, const RawValue& raw, const std::string& path) {
    if (raw.kind != RawValue::Kind::String || is_quantity(raw.text)) return Expression(real(entry, raw, path));
    try {
      Expression formula(raw.text, entry.variables);
      if (formula.is_constant()) check_range(entry, formula(std::vector<double>(entry.variables.size())), raw, path);
      return formula;
    } catch (const InputError& wrong) {
      const std::string message = wrong.what();
      if (message.rfind(raw.where(), 0) == 0) throw;  // the range check's own message, complete already
      fail(raw, path, message + ". Allowed: a quantity in " + entry.si_unit + " or a formula giving SI values");
    }
  }

  std::shared_ptr<const Node> alternative(const Entry& entry, const RawValue& raw, const std::string& path) const {
    if (raw.kind != RawValue::Kind::Table) wrong_type(entry, raw, path, "a table");
    const auto& alternatives = entry.alternatives();
    std::vector<std::string> names;
    for (const auto& item : alternatives) names.push_back(item.first);
    const RawValue* selected = raw.find(entry.selector);
    if (!selected)
      throw InputError(raw.where() + " " + path + "." + entry.selector + ": missing (" + entry.doc +
                       "). Allowed: " + joined(names) + ". Add " + entry.selector + " = " +
                       in_quotes(names.empty() ? "" : names.front()));
    const std::string name = choice(names, *selected, path + "." + entry.selector, entry.doc);
    return table(alternative_schema(entry, name, alternatives.at(name)), raw, path);
  }

  Value value(const Entry& entry, const RawValue& raw, const std::string& path) const {
    Value result;
    result.where = raw.where();
    result.shown = raw.shown();
    switch (entry.type) {
      case Entry::Type::Real:
        result.content = real(entry, raw, path);
        break;
      case Entry::Type::Reals: {
        std::vector<double> values;
        for (const auto& element : elements(entry, raw, path))
          values.push_back(real(entry, element, indexed(path, values.size())));
        result.content = std::move(values);
        break;
      }
      case Entry::Type::Integer:
        result.content = integer(entry, raw, path);
        break;
      case Entry::Type::Boolean:
        if (raw.kind != RawValue::Kind::Boolean) wrong_type(entry, raw, path, "true or false");
        result.content = raw.boolean;
        break;
      case Entry::Type::Text:
        result.content = text(entry, raw, path);
        break;
      case Entry::Type::Texts: {
        std::vector<std::string> values;
        for (const auto& element : elements(entry, raw, path))
          values.push_back(text(entry, element, indexed(path, values.size())));
        result.content = std::move(values);
        break;
      }
      case Entry::Type::Choice:
        result.content = choice(entry.choices, raw, path, entry.doc);
        break;
      case Entry::Type::Expression:
        result.content = expression(entry, raw, path);
        break;
      case Entry::Type::Table:
        if (raw.kind != RawValue::Kind::Table) wrong_type(entry, raw, path, "a table");
        result.content = table(*entry.table, raw, path);
        break;
      case Entry::Type::Variant:
        result.content = alternative(entry, raw, path);
        break;
      case Entry::Type::Tables:
      case Entry::Type::Variants: {
        std::vector<Node::NodePointer> nodes;
        for (const auto& element : elements(entry, raw, path)) {
          const std::string element_path = indexed(path, nodes.size());
          if (element.kind != RawValue::Kind::Table) wrong_type(entry, element, element_path, "a table");
          nodes.push_back(entry.type == Entry::Type::Tables ? table(*entry.table, element, element_path)
                                                            : alternative(entry, element, element_path));
        }
        result.content = std::move(nodes);
        break;
      }
    }
    return result;
  }

  /// The value of a key the user did not give: its default, or nothing when it is optional.
  std::optional<Value> standard_value(const Entry& entry, const RawValue& parent, const std::string& path) const {
    RawValue raw;
    raw.file = parent.file;
    raw.line = parent.line;
    const bool is_list = entry.type == Entry::Type::Tables || entry.type == Entry::Type::Variants;
    if (entry.default_value) {
      raw = default_number(entry, raw);
    } else if (entry.default_text) {
      raw = default_from_text(entry, raw);
    } else if (!entry.required) {
      return {};
    } else if (entry.type == Entry::Type::Table) {
      // Read as an empty table: its own keys have defaults, or the first required one is named as missing.
    } else if (is_list && entry.fewest == 0) {
      raw.kind = RawValue::Kind::Array;
    } else {
      missing(entry, parent, path);
    }
    return value(entry, raw, path);
  }

  [[noreturn]] static void missing(const Entry& entry, const RawValue& parent, const std::string& path) {
    const bool number =
        entry.type == Entry::Type::Real || entry.type == Entry::Type::Reals || entry.type == Entry::Type::Expression;
    std::string message = parent.where() + " " + path + ": missing. Meaning: " + entry.doc;
    if (number) message += " [" + entry.si_unit + "]";
    message += ".";
    if (entry.type == Entry::Type::Choice) message += " Allowed: " + joined(entry.choices) + ".";
    if (entry.type == Entry::Type::Variant || entry.type == Entry::Type::Variants) {
      std::vector<std::string> names;
      for (const auto& item : entry.alternatives()) names.push_back(item.first);
      message += " Allowed " + entry.selector + ": " + joined(names) + ".";
    }
    throw InputError(message + allowed_sentence(entry) + " Add for instance " + entry.key + " = " +
                     example_value(entry));
  }

  static RawValue default_number(const Entry& entry, RawValue raw) {
    const double number = *entry.default_value;
    if (entry.type == Entry::Type::Boolean) {
      raw.kind = RawValue::Kind::Boolean;
      raw.boolean = number != 0;
    } else if (entry.si_unit == "1") {
      raw.kind = RawValue::Kind::Real;
      raw.real = number;
    } else {
      raw.kind = RawValue::Kind::String;
      raw.text = shortest(number) + " " + entry.si_unit;
    }
    return raw;
  }

  static RawValue default_from_text(const Entry& entry, RawValue raw) {
    const std::string& text = *entry.default_text;
    const bool textual = entry.type == Entry::Type::Real || entry.type == Entry::Type::Expression ||
                         entry.type == Entry::Type::Text || entry.type == Entry::Type::Choice;
    if (entry.type == Entry::Type::Variant) {
      RawValue name;
      name.kind = RawValue::Kind::String;
      name.text = text;
      name.file = raw.file;
      name.line = raw.line;
      raw.members.push_back({entry.selector, name});
    } else if (textual) {
      raw.kind = RawValue::Kind::String;
      raw.text = text;
    } else {
      const RawValue read = read_value(text, raw.file);
      raw.kind = read.kind;
      raw.boolean = read.boolean;
      raw.integer = read.integer;
      raw.real = read.real;
      raw.text = read.text;
      raw.array = read.array;
      raw.members = read.members;
    }
    return raw;
  }

  std::string folder_;
};

}  // namespace

Parameters parse_text(const std::string& text, const std::string& name, const Schema& schema, const std::string& folder,
                      const std::vector<std::string>& overrides) {
  RawValue root = read_toml(text, name);
  for (const auto& assignment : overrides) apply_override(root, assignment);
  return Parameters(Checker(folder).table(schema, root, ""));
}

Parameters parse_file(const std::string& path, const Schema& schema, const std::vector<std::string>& overrides) {
  std::ifstream file(path);
  std::error_code failure;
  if (!file || !std::filesystem::is_regular_file(path, failure))
    throw InputError(path + ": cannot read the input file. Check the name and the permissions");
  std::ostringstream text;
  text << file.rdbuf();
  const auto slash = path.find_last_of('/');
  const std::string folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
  return parse_text(text.str(), path, schema, folder, overrides);
}

}  // namespace stirsph::input
