#pragma once
// Expressions of a user-defined model: grammar and syntax tree.
//   precedence, lowest first:  < > <= >=   + -   * /   unary -   ^ (whole exponent 0 ... 16)
//   functions:                 min max abs sqrt exp log sin cos clamp deadband select
// A comparison may occur only as the first argument of select, or as a whole condition.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::sim::user_models {

/// Operation of a node.
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
  less,       ///< comparisons; > and >= are stored with exchanged operands
  less_equal,
  power  ///< exponent in `value`
};

struct Node;
using Tree = std::shared_ptr<const Node>;
/// Node of the syntax tree; `op` determines which fields are used.
struct Node {
  Op op;
  double value = 0.0;  ///< value of a number, or exponent of a power
  std::string name;    ///< identifier of a name
  std::vector<Tree> arguments;
  std::size_t at = 0;  ///< offset in the text
};

/// Error in an expression, with its character offset.
struct Fault {
  std::size_t at;
  std::string what, why, remedy;
};

/// Parses a value (no comparison at the top level). Returns nullptr and sets `fault` on an error.
Tree parse_value(std::string_view text, Fault& fault);
/// Parses a comparison `a < b`. Returns nullptr and sets `fault` on an error.
Tree parse_condition(std::string_view text, Fault& fault);

/// Returns the function names "min, max, ..." for messages.
std::string function_names();
bool is_function(std::string_view name);
/// Returns true for a name of letters, digits and _ that does not begin with a digit.
bool is_identifier(std::string_view name);

}  // namespace swingbank::sim::user_models
