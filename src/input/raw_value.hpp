/// TOML as read, with the file and line of every value and before any check against a schema.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stirsph::input {

/// One TOML value. Keeps toml11's headers, which are slow to compile, out of everything but raw_value.cpp.
struct RawValue {
  enum class Kind { Boolean, Integer, Real, String, Array, Table, Date };

  Kind kind = Kind::Table;
  bool boolean = false;
  std::int64_t integer = 0;
  double real = 0;
  struct Member;                ///< a key and its value
  std::string text;             ///< String; Date as written; of the command line, any scalar as written
  std::vector<RawValue> array;  ///< Array
  std::vector<Member> members;  ///< Table, in the order of the file
  std::string file;
  int line = 0;  ///< 0: not from a file (command line, default)

  bool is_number() const { return kind == Kind::Integer || kind == Kind::Real; }
  double number() const { return kind == Kind::Integer ? static_cast<double>(integer) : real; }
  const RawValue* find(std::string_view key) const;
  RawValue* find(std::string_view key);
  std::string where() const;           ///< "file:line", or "file" without a line
  std::string shown() const;           ///< the value as a message shows it: quoted strings, [..], {..} shortened
  std::string_view kind_name() const;  ///< "a table", "an integer", ...
};

struct RawValue::Member {
  std::string key;
  RawValue value;
};

/// The tree of a TOML text; throws InputError with file and line when the syntax is wrong.
RawValue read_toml(const std::string& text, const std::string& name);

/// The value written in `text`: TOML if it is that, else a string of the text itself.
RawValue read_value(const std::string& text, const std::string& file);

/// Sets "section.key=value" or "body.0.key=value" (also body[0].key) in the tree. Throws InputError.
void apply_override(RawValue& root, const std::string& assignment);

}  // namespace stirsph::input
