/// Validated input: every value checked against its schema and converted to SI.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/tensor.hpp"
#include "input/expression.hpp"
#include "input/schema.hpp"

namespace stirsph::input {

/// The values of one table. All getters throw Error(Internal) when the key was not declared with that type.
class Parameters {
 public:
  bool has(std::string_view key) const;  ///< given by the user or by a default
  double real(std::string_view key) const;
  std::vector<double> reals(std::string_view key) const;
  Vec3 vector(std::string_view key) const;  ///< reals of 2 or 3 elements; a missing z is 0
  std::int64_t integer(std::string_view key) const;
  bool boolean(std::string_view key) const;
  const std::string& text(std::string_view key) const;  ///< Text or Choice
  std::vector<std::string> texts(std::string_view key) const;
  /// Path of a text declared as file(): relative names lie beside the input file. Fails when there is no such file.
  std::string file(std::string_view key) const;
  Expression expression(std::string_view key) const;
  Parameters table(std::string_view key) const;                ///< Table or Variant
  std::vector<Parameters> tables(std::string_view key) const;  ///< Tables or Variants

  /// "file:line" of the key (of the table when the key is absent), for messages.
  std::string where(std::string_view key = {}) const;
  /// Throws InputError "file:line section.key = value: message" for errors only the caller can see.
  [[noreturn]] void fail(std::string_view key, const std::string& message) const;
  /// Folder of the file the table came from: relative paths in it mean files beside it.
  std::string folder() const;

  /// The effective input, defaults included, as TOML with a comment for each key's meaning. Names of files are
  /// absolute, so that the text means the same wherever it is put.
  std::string as_toml() const;

  struct Node;  ///< defined in node.hpp
  explicit Parameters(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

 private:
  std::shared_ptr<const Node> node_;
};

/// Reads a TOML file and checks it. `overrides` are "section.key=value" strings of the command line (value as in TOML;
/// bare text is taken as a string). Errors are InputError with file, line, key, value, what is allowed and the nearest
/// name.
Parameters parse_file(const std::string& path, const Schema& schema, const std::vector<std::string>& overrides = {});
/// The same for text already in memory; `name` stands in messages, `folder` for relative paths.
Parameters parse_text(const std::string& text, const std::string& name, const Schema& schema,
                      const std::string& folder = ".", const std::vector<std::string>& overrides = {});

/// The parameter manual of a schema as Markdown.
std::string manual(const Schema& schema, const std::string& title);

}  // namespace stirsph::input
