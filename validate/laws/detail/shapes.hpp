#pragma once
// Shapes of laws that follow the clock: what they put out over the time since their beginning.
#include <functional>
#include <string>
#include <vector>

#include "validate/laws/candidate.hpp"

namespace swingbank::validate::laws {

struct LawShape {
  enum class Kind { once, wave, sine };  ///< wave: its phase is zero when it begins; sine: any phase
  Kind kind = Kind::once;
  std::string family;
  std::function<double(double tau, double b)> course;  ///< [1]; b: its second number
  std::vector<double> grid = {};                       ///< of b; empty: it has none
  LawParameter second = {};
  std::string value;         ///< of the law file, with tau for the time since the beginning
  std::string signals = "";  ///< further lines of [signals]
  std::string words;         ///< with {A}, {begin} and the second parameter's name
};

/// `length`: of the records from their first switching on [s].
std::vector<LawShape> law_shapes(double length);

}  // namespace swingbank::validate::laws
