#include "input/expression.hpp"

#include <muParser.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "input/wording.hpp"

namespace stirsph::input {

struct Expression::Parser {
  std::string text;
  std::vector<std::string> variables;
  std::vector<double> storage;  ///< the variables' values; the compiled formula points here
  bool is_constant = true;
  double constant = 0;
  mu::Parser compiled;
};

namespace {

/// muParser lets "t = 3" assign; in an input file that can only be a slip for "==" or a stray character.
bool assigns(const std::string& formula) {
  for (std::size_t i = 0; i < formula.size(); ++i) {
    if (formula[i] != '=') continue;
    if (i + 1 < formula.size() && formula[i + 1] == '=') {
      ++i;
      continue;
    }
    if (i == 0 || std::string_view("<>!").find(formula[i - 1]) == std::string_view::npos) return true;
  }
  return false;
}

std::string known_names(const std::vector<std::string>& variables) {
  std::vector<std::string> names = variables;
  names.push_back("pi");
  return "Known names: " + joined(names) +
         "; functions: sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, ln, log10, sqrt, abs, sign, min, max";
}

}  // namespace

Expression::Expression(const std::string& formula, const std::vector<std::string>& variables)
    : parser_(std::make_shared<Parser>()) {
  Parser& p = *parser_;
  p.text = formula;
  p.variables = variables;
  p.storage.assign(variables.size(), 0.0);
  if (trimmed(formula).empty()) throw InputError("the formula is empty. " + known_names(variables));
  if (assigns(formula))
    throw InputError("the formula \"" + formula + "\" contains an assignment '='. Comparisons are written ==, <=, >=");
  try {
    p.compiled.DefineConst("pi", std::numbers::pi);
    for (std::size_t i = 0; i < variables.size(); ++i) p.compiled.DefineVar(variables[i], &p.storage[i]);
    p.compiled.SetExpr(formula);
    int results = 0;
    p.compiled.Eval(results);
    if (results != 1)
      throw InputError("the formula \"" + formula + "\" gives " + std::to_string(results) +
                       " values; write one, with a decimal point rather than a comma");
    p.is_constant = p.compiled.GetUsedVar().empty();
    if (p.is_constant) p.constant = p.compiled.Eval();
  } catch (const mu::Parser::exception_type& wrong) {
    throw InputError("the formula \"" + formula + "\" is wrong at position " + std::to_string(wrong.GetPos() + 1) +
                     ": " + wrong.GetMsg() + ". " + known_names(variables));
  }
  if (p.is_constant && !std::isfinite(p.constant))
    throw InputError("the formula \"" + formula + "\" gives " + shortest(p.constant) + ", not a finite number");
}

Expression::Expression(double value) : parser_(std::make_shared<Parser>()) {
  parser_->constant = value;
  parser_->text = shortest(value);
}

double Expression::operator()(const std::vector<double>& values) const {
  if (!parser_) throw Error(ExitCode::Internal, "an empty formula was evaluated");
  Parser& p = *parser_;
  if (p.is_constant) return p.constant;
  if (values.size() != p.storage.size())
    throw Error(ExitCode::Internal, "the formula \"" + p.text + "\" takes " + std::to_string(p.storage.size()) +
                                        " values, got " + std::to_string(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) p.storage[i] = values[i];
  double result = 0;
  try {
    result = p.compiled.Eval();
  } catch (const mu::Parser::exception_type& wrong) {
    throw InputError("the formula \"" + p.text + "\" cannot be evaluated: " + wrong.GetMsg());
  }
  if (!std::isfinite(result)) {
    std::string at;
    for (std::size_t i = 0; i < values.size(); ++i)
      at += (i ? ", " : "") + p.variables[i] + " = " + shortest(values[i]);
    throw InputError("the formula \"" + p.text + "\" gives " + shortest(result) + " at " + at +
                     ". It must have a value wherever and whenever it is used");
  }
  return result;
}

const std::string& Expression::text() const {
  if (!parser_) throw Error(ExitCode::Internal, "an empty formula was asked for its text");
  return parser_->text;
}

bool Expression::contains(const std::string& variable) const {
  return !is_constant() && parser_->compiled.GetUsedVar().contains(variable);
}
bool Expression::is_constant() const { return !parser_ || parser_->is_constant; }

}  // namespace stirsph::input
