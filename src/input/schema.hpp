/// Declared parameters: every key a scene or material file may hold, with its unit, range, default and one-line
/// meaning. Parsing, validation, the effective-input writer and the parameter manual all work from the declaration.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stirsph::input {

class Schema;

/// One declared key. The setters return *this so that a declaration reads as one sentence.
class Entry {
 public:
  enum class Type { Real, Reals, Integer, Boolean, Text, Texts, Choice, Expression, Table, Tables, Variant, Variants };

  Entry& unit(std::string si_unit);                       ///< SI unit the value is converted to ("1" when not called)
  Entry& optional();                                      ///< may be missing, has no default: Parameters::has() tells
  Entry& by_default(std::string text);                    ///< as a user would write it: "0.4 mm", "true", "cubic"
  Entry& by_default(double value_in_si);                  ///< in the SI unit; bare numbers: dimensionless entries
  Entry& positive();                                      ///< > 0
  Entry& not_negative();                                  ///< >= 0
  Entry& range(double lowest, double highest);            ///< inclusive, in the SI unit
  Entry& count(std::size_t lowest, std::size_t highest);  ///< number of elements of Reals, Texts, Variants
  Entry& file();                                          ///< names a file; a relative one lies beside the input file
  Entry& difference();  ///< a difference, not a point on a scale: "5 degC" is 5 K, not 278.15 K

  std::string key;
  std::string doc;
  Type type = Type::Real;
  std::string si_unit = "1";
  bool required = true;
  std::optional<std::string> default_text;
  std::optional<double> default_value;  ///< by_default(double)
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool lowest_excluded = false;
  bool is_difference = false;
  bool is_file = false;
  std::size_t fewest = 0, most = std::numeric_limits<std::size_t>::max();
  std::vector<std::string> choices;    ///< Choice
  std::vector<std::string> variables;  ///< Expression: names the formula may use
  std::shared_ptr<Schema> table;       ///< Table, Tables
  std::string selector;                ///< Variant, Variants: the key whose value picks the alternative
  std::function<const std::map<std::string, Schema>&()> alternatives;  ///< called late, so that shapes may hold shapes
};

/// The keys of one table, in the order they were declared.
class Schema {
 public:
  Schema() = default;
  explicit Schema(std::string text) : doc(std::move(text)) {}

  Entry& real(std::string key, std::string doc);   ///< "12 kN", or a bare number when the unit is "1"
  Entry& reals(std::string key, std::string doc);  ///< ["0 mm", "1 mm", "2 mm"]
  Entry& integer(std::string key, std::string doc);
  Entry& boolean(std::string key, std::string doc);
  Entry& text(std::string key, std::string doc);
  Entry& texts(std::string key, std::string doc);
  Entry& choice(std::string key, std::vector<std::string> choices, std::string doc);
  /// A quantity that may vary: a string "10 m/s" or a formula over `variables` giving SI values: "0.1*sin(300*t)".
  Entry& expression(std::string key, std::vector<std::string> variables, std::string doc);
  /// A table [key]; fill the returned schema. A missing table is read as if all its keys were missing when every key
  /// has a default or is optional, unless `optional()` is set on the entry.
  Schema& table(std::string key, std::string doc, bool optional = false);
  /// An array of tables [[key]] with at least `fewest` elements.
  Schema& tables(std::string key, std::string doc, std::size_t fewest = 0);
  /// A table whose key `selector` names one of several alternatives, each with keys of its own.
  Entry& variant(std::string key, std::string selector,
                 std::function<const std::map<std::string, Schema>&()> alternatives, std::string doc);
  Entry& variants(std::string key, std::string selector,
                  std::function<const std::map<std::string, Schema>&()> alternatives, std::string doc);

  /// Adds all keys of another schema, for keys that several tables share.
  Schema& include(const Schema& other);

  const std::vector<std::shared_ptr<Entry>>& entries() const { return entries_; }
  const Entry* find(std::string_view key) const;
  std::string doc;

 private:
  Entry& add(std::string key, Entry::Type type, std::string doc);
  std::vector<std::shared_ptr<Entry>> entries_;
};

}  // namespace stirsph::input
