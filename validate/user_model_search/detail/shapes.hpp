#pragma once
// Shapes of user-defined models of time: their outputs as functions of the time since their start.
#include <functional>
#include <string>
#include <vector>

#include "validate/user_model_search/candidate.hpp"

namespace swingbank::validate::user_model_search {

/// A shape of a user-defined model of time.
struct UserModelShape {
  enum class Kind {
    once,  ///< not periodic
    wave,  ///< periodic, zero phase at the start
    sine   ///< periodic, any phase
  };
  Kind kind = Kind::once;
  std::string family;
  /// Output [-] at the time tau since the start; for a sine, its envelope. b: second parameter.
  std::function<double(double tau, double b)> time_series;
  std::vector<double> grid = {};  ///< values of b; empty: no second parameter
  UserModelParameter second = {};
  std::string value;         ///< expression of the TOML file; tau is the time since the start
  std::string signals = "";  ///< further lines of [signals]
  std::string words;         ///< description with {A}, {begin} and the second parameter's name
};

/// Returns all shapes. `length`: duration of the inferred input [s].
std::vector<UserModelShape> user_model_shapes(double length);

}  // namespace swingbank::validate::user_model_search
