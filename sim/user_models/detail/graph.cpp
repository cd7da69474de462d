#include "sim/user_models/detail/graph.hpp"

#include <algorithm>

namespace swingbank::sim::user_models {

int signal_index(std::string_view name) {
  const auto* at = std::ranges::find(kSignals, name, &SignalRecord::name);
  return at == kSignals.end() ? -1 : static_cast<int>(at - kSignals.begin());
}

int Graph::add(Vertex vertex) {
  const auto key = std::tuple{vertex.act, vertex.index, vertex.from};
  const auto found = known_.find(key);
  if (found != known_.end()) return found->second;
  if (vertices_.size() >= kMost) throw TooLarge{};
  const int place = static_cast<int>(vertices_.size());
  vertices_.push_back(vertex);
  known_.emplace(key, place);
  return place;
}

int Graph::constant(double value) {
  const auto found = by_value_.find(value);
  if (found != by_value_.end()) return found->second;
  Vertex v{Act::coefficient};
  v.fixed = v.parameters = true;
  v.index = -2 - static_cast<int>(constants_.size());  // compile() assigns its coefficient
  const int place = add(v);
  by_value_.emplace(value, place);
  constants_.emplace(place, value);
  return place;
}
int Graph::coefficient(int index, bool parameter) {
  Vertex v{Act::coefficient, index};
  v.fixed = true;
  v.parameters = parameter;
  return add(v);
}
int Graph::state(int index) { return add(Vertex{Act::state, index}); }
int Graph::signal(int index) { return add(Vertex{Act::signal, index}); }

int Graph::make(Act act, int a, int b, int c, int d) {
  Vertex v{act, -1, {a, b, c, d}};
  v.fixed = v.parameters = true;
  for (const int from : v.from) {
    if (from < 0) continue;
    v.fixed = v.fixed && (*this)[from].fixed;
    v.parameters = v.parameters && (*this)[from].parameters;
  }
  return add(v);
}

int Graph::power(int a, int exponent) {
  if (exponent == 0) return constant(1.0);
  int result = -1;
  for (int square = a, rest = exponent; rest > 0; rest /= 2) {
    if (rest % 2 == 1) result = result < 0 ? square : make(Act::multiply, result, square);
    if (rest > 1) square = make(Act::multiply, square, square);
  }
  return result;
}

/// Returns the vertex of dead_band() in blocks.hpp.
int Graph::dead_band(int u, int width) {
  const int zero = constant(0.0);
  const auto positive_part = [&](int a) { return make(Act::select_less, zero, a, a, zero); };
  const int above = positive_part(make(Act::subtract, u, width));
  const int below = positive_part(make(Act::subtract, negate(u), width));
  return make(Act::subtract, above, below);
}

}  // namespace swingbank::sim::user_models
