#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "processing/models/unit_dimension.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky {

/// A name that a formula may use, with the dimension of what it stands for.
struct FormulaSymbol {
  std::string name;
  Dimension dimension{};
};

/// An expression of complex arithmetic, compiled to a flat program that runs over a whole path at
/// once. Only functions that are analytic in their argument are known (exp, log, sqrt, sin, cos,
/// tan, sinh, cosh, tanh, with + - * / ^ and brackets), so that what holds on the imaginary axis
/// holds on a damped line beside it. `pi` and the imaginary unit `i` are known; `omega` is -i s
/// where `s` is.
///
/// Dimensions are checked as it is read: sums of like with like, functions of pure numbers, powers
/// of what has a unit with a constant exponent.
class Formula {
 public:
  static constexpr std::size_t kLongest = 2000;  ///< characters
  static constexpr std::size_t kMostSteps = 256;

  /// @throws InputError whose place is "column N"
  Formula(const std::string& text, std::vector<FormulaSymbol> symbols);

  [[nodiscard]] const Dimension& dimension() const { return steps_.back().dimension; }
  [[nodiscard]] bool uses(const std::string& symbol) const;
  [[nodiscard]] std::size_t steps() const { return steps_.size(); }

  /// @param values  one per symbol, each along the path, or one number for all of it
  void evaluate(std::span<const std::span<const Complex>> values, std::span<Complex> out) const;

 private:
  friend class FormulaReader;

  enum class Step : std::uint8_t {
    constant,
    symbol,
    add,
    subtract,
    multiply,
    divide,
    negate,
    power,
    whole_power,
    exp,
    log,
    sqrt,
    sin,
    cos,
    tan,
    sinh,
    cosh,
    tanh
  };

  /// One step; its operands are earlier ones.
  struct Operation {
    Step step = Step::constant;
    std::uint16_t a = 0;  ///< operand, or the symbol's place
    std::uint16_t b = 0;
    int whole = 0;  ///< exponent of a whole power
    Complex constant{};
    Dimension dimension{};
  };

  [[nodiscard]] static Complex apply(const Operation& operation, Complex a, Complex b);
  static void run(const Operation& operation, const Complex* a, const Complex* b, Complex* out,
                  std::size_t count);

  std::vector<FormulaSymbol> symbols_;
  std::vector<Operation> steps_;
};

}  // namespace kolsky
