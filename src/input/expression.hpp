/// Formulas in input files ("3*sin(2*pi*x/L)"), evaluated with muParser. Values are SI.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace stirsph::input {

/// A compiled formula over named variables; cheap to copy (the parser is shared), not thread-safe.
class Expression {
 public:
  Expression() = default;
  /// Throws InputError naming the position and the known names when the formula is wrong.
  Expression(const std::string& formula, const std::vector<std::string>& variables);
  /// A constant.
  explicit Expression(double value);

  /// `values` in the order of the variables given to the constructor.
  double operator()(const std::vector<double>& values) const;
  const std::string& text() const;
  bool is_constant() const;
  /// Whether the formula contains this variable.
  bool contains(const std::string& variable) const;

 private:
  struct Parser;
  std::shared_ptr<Parser> parser_;
};

}  // namespace stirsph::input
