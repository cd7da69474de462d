#include "sim/user_models/detail/expression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace swingbank::sim::user_models {
namespace {

struct Function {
  std::string_view name;
  Op op;
  std::size_t arguments;
};
constexpr std::array kFunctions = {
    Function{"min", Op::minimum, 2},     Function{"max", Op::maximum, 2},
    Function{"abs", Op::absolute, 1},    Function{"sqrt", Op::square_root, 1},
    Function{"exp", Op::exponential, 1}, Function{"log", Op::logarithm, 1},
    Function{"sin", Op::sine, 1},        Function{"cos", Op::cosine, 1},
    Function{"clamp", Op::clamp, 3},     Function{"deadband", Op::dead_band, 2},
    Function{"select", Op::select, 3}};

const Function* find_function(std::string_view name) {
  const auto* at = std::ranges::find(kFunctions, name, &Function::name);
  return at == kFunctions.end() ? nullptr : at;
}

// ASCII only, independent of the locale.
bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }
bool blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// A binary operator and its precedence.
struct Operator {
  std::string_view sign;
  Op op;
  int binding;
  bool turned = false;  ///< exchange the operands: a > b is b < a
};
constexpr int kCompare = 1, kSum = 2, kProduct = 3, kSign = 4, kPower = 5;
constexpr std::array kOperators = {Operator{"<=", Op::less_equal, kCompare},
                                   Operator{">=", Op::less_equal, kCompare, true},
                                   Operator{"<", Op::less, kCompare},
                                   Operator{">", Op::less, kCompare, true},
                                   Operator{"+", Op::add, kSum},
                                   Operator{"-", Op::subtract, kSum},
                                   Operator{"*", Op::multiply, kProduct},
                                   Operator{"/", Op::divide, kProduct},
                                   Operator{"^", Op::power, kPower}};

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Tree whole(bool condition) {
    Tree tree = expression(0);
    skip();
    if (at_ < text_.size())
      fail(at_, fmt::format("'{}' after the end of the expression", text_.substr(at_, 1)),
           "an operator or the end is expected here", "remove it or put an operator before it");
    if (compares(*tree) != condition)
      fail(tree->at,
           condition ? "a value where a condition is needed" : "a comparison where a value is needed",
           condition ? "a condition is a < b, a > b, a <= b or a >= b"
                     : "a comparison is allowed only as the first argument of select",
           condition ? "write a comparison" : "write select(a < b, value, other value)");
    return tree;
  }

 private:
  static constexpr int kDeepest =
      100;  ///< maximum nesting of brackets and signs; bounds the parser's recursion
  static constexpr double kLargestPower = 16;

  static bool compares(const Node& n) { return n.op == Op::less || n.op == Op::less_equal; }
  [[noreturn]] static void fail(std::size_t at, std::string what, std::string why, std::string remedy) {
    throw Fault{at, std::move(what), std::move(why), std::move(remedy)};
  }
  void skip() {
    while (at_ < text_.size() && blank(text_[at_])) ++at_;
  }
  bool take(std::string_view sign) {
    skip();
    if (!text_.substr(at_).starts_with(sign)) return false;
    at_ += sign.size();
    return true;
  }
  const Operator* peek_operator() {
    skip();
    for (const Operator& o : kOperators)
      if (text_.substr(at_).starts_with(o.sign)) return &o;
    return nullptr;
  }
  static Tree node(Op op, std::vector<Tree> arguments, std::size_t at, double value = 0.0) {
    return std::make_shared<Node>(Node{op, value, {}, std::move(arguments), at});
  }
  static Tree value_only(Tree tree) {
    if (compares(*tree))
      fail(tree->at, "a comparison inside an expression",
           "a comparison is allowed only as the first argument of select",
           "write select(a < b, value, other value)");
    return tree;
  }

  /// Parses operators with a higher precedence than `binding`.
  Tree expression(int binding) {
    if (++depth_ > kDeepest)
      fail(at_, "an expression nested too deeply", fmt::format("at most {} levels are read", kDeepest),
           "split the expression with [signals]");
    Tree left = operand();
    while (const Operator* o = peek_operator()) {
      if (o->binding <= binding) break;
      const std::size_t at = at_;
      at_ += o->sign.size();
      left = o->op == Op::power ? power(value_only(std::move(left)), at) : join(*o, std::move(left), at);
    }
    --depth_;
    return left;
  }
  Tree join(const Operator& o, Tree left, std::size_t at) {
    Tree right = value_only(expression(o.binding));
    left = value_only(std::move(left));
    if (o.turned) std::swap(left, right);
    return node(o.op, {std::move(left), std::move(right)}, at);
  }
  Tree power(Tree base, std::size_t at) {
    skip();
    const std::size_t start = at_;
    if (start >= text_.size() || !digit(text_[start])) bad_power(start);
    const Tree exponent = number();
    if (exponent->value > kLargestPower || exponent->value != std::floor(exponent->value)) bad_power(start);
    return node(Op::power, {std::move(base)}, at, exponent->value);
  }
  [[noreturn]] static void bad_power(std::size_t at) {
    fail(at, "an exponent that is no whole number from 0 to 16", "powers are products of equal factors",
         "use 0 to 16, or exp(a*log(x))");
  }

  Tree operand() {
    skip();
    const std::size_t at = at_;
    if (at_ >= text_.size()) fail(at, "the expression ends too early", "a value is missing", "complete it");
    if (take("-")) return node(Op::negate, {value_only(expression(kSign))}, at);
    if (take("+")) return value_only(expression(kSign));
    if (take("(")) {
      Tree inside = expression(0);
      close(at);
      return inside;
    }
    if (digit(text_[at_]) || text_[at_] == '.') return number();
    if (letter(text_[at_])) return name();
    fail(at, fmt::format("'{}' in an expression", printable(text_[at_])), "a value is expected here",
         "write a number, a name, a function or a bracket");
  }
  static std::string printable(char c) {
    return c >= ' ' && c <= '~' ? std::string(1, c) : fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }
  void close(std::size_t opened) {
    if (!take(")"))
      fail(at_, "a missing ')'", fmt::format("the '(' at character {} is not closed", opened + 1),
           "close it");
  }
  Tree number() {
    const std::size_t at = at_;
    double value = 0.0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value))
      fail(at, "an invalid number", "it is malformed or too large", "write it like 2.5e-3");
    at_ = static_cast<std::size_t>(end - text_.data());
    if (at_ < text_.size() && letter(text_[at_]))
      fail(at_, "a name directly after a number", "there is no operator between them", "write 2*x, not 2x");
    return node(Op::number, {}, at, value);
  }
  Tree name() {
    const std::size_t at = at_;
    while (at_ < text_.size() && (letter(text_[at_]) || digit(text_[at_]))) ++at_;
    const std::string word(text_.substr(at, at_ - at));
    const std::size_t bracket = at_;
    if (take("(")) return call(word, at, bracket);
    if (is_function(word))
      fail(at, "function " + word + " without arguments", "a function is called with brackets",
           "write " + word + "(...)");
    return std::make_shared<Node>(Node{Op::name, 0.0, word, {}, at});
  }
  Tree call(const std::string& word, std::size_t at, std::size_t bracket) {
    const Function* f = find_function(word);
    if (!f)
      fail(at, "unknown function " + word, "no such function exists", "use one of: " + function_names());
    std::vector<Tree> arguments;
    if (!take(")")) {
      do arguments.push_back(expression(0));
      while (take(","));
      close(bracket);
    }
    if (arguments.size() != f->arguments)
      fail(at, fmt::format("{} with {} arguments", word, arguments.size()),
           fmt::format("it takes {}", f->arguments), "give that many, separated by commas");
    if (f->op == Op::select && !compares(*arguments[0]))
      fail(arguments[0]->at, "a value as the condition of select",
           "a condition is a < b, a > b, a <= b or a >= b", "write a comparison");
    for (std::size_t i = f->op == Op::select ? 1 : 0; i < arguments.size(); ++i)
      arguments[i] = value_only(arguments[i]);
    return node(f->op, std::move(arguments), at);
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

Tree parse(std::string_view text, bool condition, Fault& fault) {
  try {
    return Parser(text).whole(condition);
  } catch (const Fault& f) {
    fault = f;
    return nullptr;
  }
}

}  // namespace

Tree parse_value(std::string_view text, Fault& fault) { return parse(text, false, fault); }
Tree parse_condition(std::string_view text, Fault& fault) { return parse(text, true, fault); }

std::string function_names() {
  std::string names;
  for (const Function& f : kFunctions) names += (names.empty() ? "" : ", ") + std::string(f.name);
  return names;
}
bool is_function(std::string_view name) { return find_function(name) != nullptr; }
bool is_identifier(std::string_view name) {
  return !name.empty() && letter(name[0]) &&
         std::ranges::all_of(name, [](char c) { return letter(c) || digit(c); });
}

}  // namespace swingbank::sim::user_models
