#include "processing/models/formula.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// "a pure number", "what is in s".
std::string in_words(const Dimension& dimension) {
  return dimension.none() ? "a pure number" : "what is in " + dimension.text();
}

constexpr std::size_t kLanes = 64;
constexpr int kDeepest = 48;
constexpr int kLargestWhole = 32;

bool digit(char c) {
  return c >= '0' && c <= '9';
}

bool letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

Complex whole_power(Complex base, int exponent) {
  Complex result = 1.0;
  Complex square = base;
  for (int left = std::abs(exponent); left > 0; left /= 2) {
    if (left % 2 == 1) {
      result *= square;
    }
    square *= square;
  }
  return exponent < 0 ? 1.0 / result : result;
}

}  // namespace

/// Recursive descent; every rule appends its operation and returns its place.
class FormulaReader {
 public:
  FormulaReader(const std::string& text, Formula& formula) : text_(text), formula_(formula) {}

  void read() {
    if (text_.size() > Formula::kLongest) {
      refuse("is longer than " + std::to_string(Formula::kLongest) + " characters", "shorten it");
    }
    (void)sum();
    skip();
    if (at_ < text_.size()) {
      refuse(std::string("has '") + text_[at_] + "' where an operator or the end was expected",
             "write products with *, powers with ^");
    }
  }

 private:
  using Step = Formula::Step;
  using Operation = Formula::Operation;

  [[noreturn]] void refuse(const std::string& what, const std::string& mend) const {
    throw InputError("column " + std::to_string(at_ + 1), what, mend);
  }

  void skip() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) {
      ++at_;
    }
  }

  bool take(char c) {
    skip();
    if (at_ < text_.size() && text_[at_] == c) {
      ++at_;
      return true;
    }
    return false;
  }

  const Operation& operation(std::uint16_t place) const { return formula_.steps_[place]; }

  std::uint16_t append(Operation own) {
    if (formula_.steps_.size() >= Formula::kMostSteps) {
      refuse("takes more than " + std::to_string(Formula::kMostSteps) + " steps", "simplify it");
    }
    formula_.steps_.push_back(own);
    return static_cast<std::uint16_t>(formula_.steps_.size() - 1);
  }

  std::uint16_t constant(Complex value) {
    Operation own;
    own.constant = value;
    return append(own);
  }

  bool is_constant(std::uint16_t place) const { return operation(place).step == Step::constant; }

  /// Appends an operation, or what it gives where its operands are constants.
  std::uint16_t combine(Operation own, bool binary) {
    if (is_constant(own.a) && (!binary || is_constant(own.b)) && own.dimension.none()) {
      const Complex value = Formula::apply(own, operation(own.a).constant,
                                           operation(binary ? own.b : own.a).constant);
      if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) {
        refuse("works out to what is not finite", "check its numbers");
      }
      return constant(value);
    }
    return append(own);
  }

  std::uint16_t join(Step step, std::uint16_t a, std::uint16_t b) {
    Operation own;
    own.step = step;
    own.a = a;
    own.b = b;
    const Dimension& left = operation(a).dimension;
    const Dimension& right = operation(b).dimension;
    if (step == Step::add || step == Step::subtract) {
      if (!left.same(right)) {
        refuse("adds " + in_words(left) + " to " + in_words(right),
               "make the units of both sides the same");
      }
      own.dimension = left;
    } else {
      own.dimension = left.times(right, step == Step::multiply ? 1.0 : -1.0);
    }
    return combine(own, true);
  }

  std::uint16_t sum() {
    std::uint16_t left = product();
    for (;;) {
      if (take('+')) {
        left = join(Step::add, left, product());
      } else if (take('-')) {
        left = join(Step::subtract, left, product());
      } else {
        return left;
      }
    }
  }

  std::uint16_t product() {
    std::uint16_t left = sign();
    for (;;) {
      if (take('*')) {
        left = join(Step::multiply, left, sign());
      } else if (take('/')) {
        left = join(Step::divide, left, sign());
      } else {
        return left;
      }
    }
  }

  std::uint16_t sign() {
    if (++depth_ > kDeepest) {
      refuse("is nested too deeply", "simplify it");
    }
    std::uint16_t result = 0;
    if (take('-')) {
      const std::uint16_t operand = sign();
      Operation own;
      own.step = Step::negate;
      own.a = own.b = operand;
      own.dimension = operation(operand).dimension;
      result = combine(own, false);
    } else {
      (void)take('+');
      result = power();
    }
    --depth_;
    return result;
  }

  std::uint16_t power() {
    const std::uint16_t base = primary();
    if (!take('^')) {
      return base;
    }
    // From the right, and with a sign of its own: 2^-s^2.
    return raise(base, sign());
  }

  std::uint16_t raise(std::uint16_t base, std::uint16_t exponent) {
    Operation own;
    own.step = Step::power;
    own.a = base;
    own.b = exponent;
    const Operation& to = operation(exponent);
    const Dimension& dimension = operation(base).dimension;
    if (!to.dimension.none()) {
      refuse("has an exponent in " + to.dimension.text(), "make the exponent a pure number");
    }
    if (to.step == Step::constant && to.constant.imag() == 0.0) {
      const double n = to.constant.real();
      own.dimension = Dimension{}.times(dimension, n);
      if (n == std::round(n) && std::abs(n) <= kLargestWhole) {
        own.step = Step::whole_power;
        own.whole = static_cast<int>(n);
        own.b = own.a;
      }
    } else if (!dimension.none()) {
      refuse("raises what has a unit (" + dimension.text() + ") to a power that is not a number",
             "divide the base by a parameter of its unit first");
    }
    return combine(own, true);
  }

  std::uint16_t primary() {
    skip();
    if (take('(')) {
      const std::uint16_t inner = sum();
      close();
      return inner;
    }
    if (at_ < text_.size() && (digit(text_[at_]) || text_[at_] == '.')) {
      return number();
    }
    if (at_ < text_.size() && letter(text_[at_])) {
      return name();
    }
    if (at_ >= text_.size()) {
      refuse("ends where a number, a name or '(' was expected", "complete it");
    }
    refuse(std::string("has '") + text_[at_] + "' where a number, a name or '(' was expected",
           "write a number, a parameter or s there");
  }

  void close() {
    if (!take(')')) {
      refuse("lacks a ')'", "close the bracket");
    }
  }

  std::uint16_t number() {
    double value = 0.0;
    const char* begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) {
      refuse("has a number that cannot be read", "write it as 1.5e-6");
    }
    at_ += static_cast<std::size_t>(end - begin);
    return constant(value);
  }

  std::uint16_t name() {
    const std::size_t start = at_;
    while (at_ < text_.size() && (letter(text_[at_]) || digit(text_[at_]))) {
      ++at_;
    }
    const std::string own = text_.substr(start, at_ - start);
    constexpr std::array<std::pair<const char*, Step>, 9> kFunctions{{{"exp", Step::exp},
                                                                      {"log", Step::log},
                                                                      {"sqrt", Step::sqrt},
                                                                      {"sin", Step::sin},
                                                                      {"cos", Step::cos},
                                                                      {"tan", Step::tan},
                                                                      {"sinh", Step::sinh},
                                                                      {"cosh", Step::cosh},
                                                                      {"tanh", Step::tanh}}};
    for (const auto& [known, step] : kFunctions) {
      if (own == known) {
        return function(step, own);
      }
    }
    if (own == "pi") {
      return constant(std::numbers::pi);
    }
    if (own == "i") {
      return constant({0.0, 1.0});
    }
    for (std::size_t k = 0; k < formula_.symbols_.size(); ++k) {
      const FormulaSymbol& symbol = formula_.symbols_[k];
      const bool turned = own == "omega" && symbol.name == "s";
      if (own == symbol.name || turned) {
        Operation read;
        read.step = Step::symbol;
        read.a = static_cast<std::uint16_t>(k);
        read.dimension = symbol.dimension;
        const std::uint16_t value = append(read);
        return turned ? join(Step::multiply, constant({0.0, -1.0}), value) : value;
      }
    }
    at_ = start;
    refuse("names \"" + own + "\", which is nothing known here", "use one of: " + known_names());
  }

  std::string known_names() const {
    std::string list;
    for (const FormulaSymbol& symbol : formula_.symbols_) {
      list += symbol.name + (symbol.name == "s" ? ", omega, " : ", ");
    }
    return list + "pi, i";
  }

  std::uint16_t function(Step step, const std::string& own) {
    if (!take('(')) {
      refuse("lacks a '(' after " + own, "write " + own + "(...)");
    }
    const std::uint16_t argument = sum();
    const Dimension& dimension = operation(argument).dimension;
    if (step != Step::sqrt && !dimension.none()) {
      refuse("takes " + own + " of what has a unit (" + dimension.text() + ")",
             "make it a pure number");
    }
    close();
    Operation apply;
    apply.step = step;
    apply.a = apply.b = argument;
    apply.dimension = Dimension{}.times(dimension, 0.5);
    return combine(apply, false);
  }

  const std::string& text_;
  Formula& formula_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

Formula::Formula(const std::string& text, std::vector<FormulaSymbol> symbols)
    : symbols_(std::move(symbols)) {
  FormulaReader(text, *this).read();
}

bool Formula::uses(const std::string& symbol) const {
  return std::any_of(steps_.begin(), steps_.end(), [&](const Operation& own) {
    return own.step == Step::symbol && symbols_[own.a].name == symbol;
  });
}

Complex Formula::apply(const Operation& operation, Complex a, Complex b) {
  Complex result;
  run(operation, &a, &b, &result, 1);
  return result;
}

void Formula::run(const Operation& operation, const Complex* a, const Complex* b, Complex* out,
                  std::size_t count) {
  const auto each = [&](auto of) {
    for (std::size_t k = 0; k < count; ++k) {
      out[k] = of(k);
    }
  };
  switch (operation.step) {
    case Step::constant:
      return each([&](std::size_t) { return operation.constant; });
    case Step::symbol:
      return;
    case Step::add:
      return each([&](std::size_t k) { return a[k] + b[k]; });
    case Step::subtract:
      return each([&](std::size_t k) { return a[k] - b[k]; });
    case Step::multiply:
      return each([&](std::size_t k) { return a[k] * b[k]; });
    case Step::divide:
      return each([&](std::size_t k) { return a[k] / b[k]; });
    case Step::negate:
      return each([&](std::size_t k) { return -a[k]; });
    case Step::power:
      return each([&](std::size_t k) { return std::pow(a[k], b[k]); });
    case Step::whole_power:
      return each([&](std::size_t k) { return whole_power(a[k], operation.whole); });
    case Step::exp:
      return each([&](std::size_t k) { return std::exp(a[k]); });
    case Step::log:
      return each([&](std::size_t k) { return std::log(a[k]); });
    case Step::sqrt:
      return each([&](std::size_t k) { return std::sqrt(a[k]); });
    case Step::sin:
      return each([&](std::size_t k) { return std::sin(a[k]); });
    case Step::cos:
      return each([&](std::size_t k) { return std::cos(a[k]); });
    case Step::tan:
      return each([&](std::size_t k) { return std::tan(a[k]); });
    case Step::sinh:
      return each([&](std::size_t k) { return std::sinh(a[k]); });
    case Step::cosh:
      return each([&](std::size_t k) { return std::cosh(a[k]); });
    case Step::tanh:
      return each([&](std::size_t k) { return std::tanh(a[k]); });
  }
}

void Formula::evaluate(std::span<const std::span<const Complex>> values,
                       std::span<Complex> out) const {
  std::vector<Complex> lanes(steps_.size() * kLanes);
  std::vector<bool> varies(steps_.size(), false);
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Operation& own = steps_[i];
    if (own.step == Step::symbol) {
      varies[i] = values[own.a].size() > 1;
    } else if (own.step != Step::constant) {
      varies[i] = varies[own.a] || varies[own.b];
    }
  }
  const auto lane = [&](std::size_t step) { return lanes.data() + step * kLanes; };
  for (std::size_t first = 0; first < out.size(); first += kLanes) {
    const std::size_t count = std::min(kLanes, out.size() - first);
    for (std::size_t i = 0; i < steps_.size(); ++i) {
      const Operation& own = steps_[i];
      // What is the same all along the path is worked out once.
      if (!varies[i]) {
        if (first == 0) {
          if (own.step == Step::symbol) {
            *lane(i) = values[own.a].front();
          } else {
            run(own, lane(own.a), lane(own.b), lane(i), 1);
          }
          std::fill_n(lane(i), kLanes, Complex(*lane(i)));
        }
        continue;
      }
      if (own.step == Step::symbol) {
        std::copy_n(values[own.a].begin() + static_cast<std::ptrdiff_t>(first), count, lane(i));
      } else {
        run(own, lane(own.a), lane(own.b), lane(i), count);
      }
    }
    std::copy_n(lane(steps_.size() - 1), count, out.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

}  // namespace kolsky
