#include "input/schema.hpp"

#include <utility>

#include "base/error.hpp"

namespace stirsph::input {

Entry& Entry::unit(std::string unit) {
  si_unit = std::move(unit);
  return *this;
}

Entry& Entry::optional() {
  required = false;
  return *this;
}

Entry& Entry::by_default(std::string text) {
  default_text = std::move(text);
  required = false;
  return *this;
}

Entry& Entry::by_default(double value_in_si) {
  default_value = value_in_si;
  required = false;
  return *this;
}

Entry& Entry::positive() {
  lowest = 0;
  lowest_excluded = true;
  return *this;
}

Entry& Entry::not_negative() {
  lowest = 0;
  lowest_excluded = false;
  return *this;
}

Entry& Entry::range(double low, double high) {
  lowest = low;
  highest = high;
  lowest_excluded = false;
  return *this;
}

Entry& Entry::count(std::size_t low, std::size_t high) {
  fewest = low;
  most = high;
  return *this;
}

Entry& Entry::file() {
  is_file = true;
  return *this;
}

Entry& Entry::difference() {
  is_difference = true;
  return *this;
}

Entry& Schema::add(std::string key, Entry::Type type, std::string meaning) {
  if (find(key)) throw Error(ExitCode::Internal, "the schema declares the key \"" + key + "\" twice");
  auto entry = std::make_shared<Entry>();
  entry->key = std::move(key);
  entry->type = type;
  entry->doc = std::move(meaning);
  entries_.push_back(entry);
  return *entry;
}

Entry& Schema::real(std::string key, std::string meaning) {
  return add(std::move(key), Entry::Type::Real, std::move(meaning));
}
Entry& Schema::reals(std::string key, std::string meaning) {
  return add(std::move(key), Entry::Type::Reals, std::move(meaning));
}
Entry& Schema::integer(std::string key, std::string meaning) {
  return add(std::move(key), Entry::Type::Integer, std::move(meaning));
}
Entry& Schema::boolean(std::string key, std::string meaning) {
  return add(std::move(key), Entry::Type::Boolean, std::move(meaning));
}
Entry& Schema::text(std::string key, std::string meaning) {
  return add(std::move(key), Entry::Type::Text, std::move(meaning));
}
Entry& Schema::texts(std::string key, std::string meaning) {
  return add(std::move(key), Entry::Type::Texts, std::move(meaning));
}

Entry& Schema::choice(std::string key, std::vector<std::string> choices, std::string meaning) {
  Entry& entry = add(std::move(key), Entry::Type::Choice, std::move(meaning));
  entry.choices = std::move(choices);
  return entry;
}

Entry& Schema::expression(std::string key, std::vector<std::string> variables, std::string meaning) {
  Entry& entry = add(std::move(key), Entry::Type::Expression, std::move(meaning));
  entry.variables = std::move(variables);
  return entry;
}

Schema& Schema::table(std::string key, std::string meaning, bool optional) {
  Entry& entry = add(std::move(key), Entry::Type::Table, meaning);
  entry.required = !optional;
  entry.table = std::make_shared<Schema>(std::move(meaning));
  return *entry.table;
}

Schema& Schema::tables(std::string key, std::string meaning, std::size_t fewest) {
  Entry& entry = add(std::move(key), Entry::Type::Tables, meaning);
  entry.fewest = fewest;
  entry.table = std::make_shared<Schema>(std::move(meaning));
  return *entry.table;
}

Entry& Schema::variant(std::string key, std::string selector,
                       std::function<const std::map<std::string, Schema>&()> alternatives, std::string meaning) {
  Entry& entry = add(std::move(key), Entry::Type::Variant, std::move(meaning));
  entry.selector = std::move(selector);
  entry.alternatives = std::move(alternatives);
  return entry;
}

Entry& Schema::variants(std::string key, std::string selector,
                        std::function<const std::map<std::string, Schema>&()> alternatives, std::string meaning) {
  Entry& entry = variant(std::move(key), std::move(selector), std::move(alternatives), std::move(meaning));
  entry.type = Entry::Type::Variants;
  return entry;
}

Schema& Schema::include(const Schema& other) {
  for (const auto& entry : other.entries_) {
    if (find(entry->key)) throw Error(ExitCode::Internal, "the schema declares the key \"" + entry->key + "\" twice");
    entries_.push_back(entry);
  }
  return *this;
}

const Entry* Schema::find(std::string_view key) const {
  for (const auto& entry : entries_)
    if (entry->key == key) return entry.get();
  return nullptr;
}

}  // namespace stirsph::input
