#pragma once
// The expressions of a law file, as text and as a tree.
//   precedence, lowest first:  < > <= >=   + -   * /   unary -   ^ (whole exponent 0 ... 16)
//   functions:                 min max abs sqrt exp log sin cos clamp deadband select
// A comparison stands only as the first argument of select, or as a whole condition.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::sim::laws {

enum class Op : std::uint8_t {
  number,
  name,
  add,
  subtract,
  multiply,
  divide,
  negate,
  minimum,
  maximum,
  absolute,
  square_root,
  exponential,
  logarithm,
  sine,
  cosine,
  clamp,      ///< clamp(u, low, high)
  dead_band,  ///< deadband(u, width): see blocks.hpp
  select,     ///< select(a < b, then, otherwise)
  less,       ///< comparisons; > and >= are turned round
  less_equal,
  power  ///< exponent in `value`
};

struct Node;
using Tree = std::shared_ptr<const Node>;
struct Node {
  Op op;
  double value = 0.0;  ///< number, power
  std::string name;    ///< name
  std::vector<Tree> arguments;
  std::size_t at = 0;  ///< place in the text
};

/// What is wrong with an expression, and at which character.
struct Fault {
  std::size_t at;
  std::string what, why, remedy;
};

/// A value (no comparison at the top), or nullptr with the reason in `fault`.
Tree parse_value(std::string_view text, Fault& fault);
/// A comparison `a < b`, or nullptr with the reason in `fault`.
Tree parse_condition(std::string_view text, Fault& fault);

/// "min, max, ..." for messages.
std::string function_names();
bool is_function(std::string_view name);
/// Letters, digits and _, not beginning with a digit.
bool is_identifier(std::string_view name);

}  // namespace swingbank::sim::laws
