// Reader of the blocks of a user-defined model: each becomes states and an output value, with the formulas of
// sim/core/blocks.hpp.
#include <fmt/format.h>

#include <algorithm>

#include "sim/user_models/detail/reader.hpp"

namespace swingbank::sim::user_models {
namespace {
const std::vector<std::string> kKinds = {"gain",       "lag",      "lead_lag",         "washout",
                                         "integrator", "deadband", "transfer_function"};
bool limits_its_state(const std::string& kind) { return kind == "lag" || kind == "integrator"; }
}  // namespace

int Reader::add_state(const std::string& name, const std::string& meaning) {
  StateEntry s;
  s.name = name;
  s.unit = "pu";
  s.meaning = meaning;
  s.start = graph_.constant(0.0);
  states_.push_back(s);
  return static_cast<int>(states_.size()) - 1;
}

void Reader::read_blocks() {
  block_order_ = in_file_order("blocks");
  for (const std::string& name : block_order_) {
    const std::string key = "blocks." + name;
    if (!claim(key, name, "block")) continue;
    Block block;
    block.kind = config_.choice(key + ".kind", kKinds);
    if (std::ranges::find(kKinds, block.kind) == kKinds.end()) config_.ignore(key);
    blocks_.emplace(name, block);
    named_.emplace(name, Named{Named::Kind::block, {}});
  }
  if (!config_.has("chain")) return;
  std::string before;
  for (const std::string& name : config_.require<std::vector<std::string>>("chain")) {
    const auto at = blocks_.find(name);
    if (at == blocks_.end()) {
      problem("chain", 0, "block " + name, "there is no [blocks." + name + "]", "name blocks of this file");
      continue;
    }
    if (!at->second.before.empty() || name == before)
      problem("chain", 0, "block " + name + " twice", "a block has one input", "name it once");
    at->second.before = before.empty() ? "input" : before;
    before = name;
  }
  last_in_chain_ = before;
}

int Reader::block_input(const std::string& name) {
  const std::string key = "blocks." + name + ".input";
  const std::string& before = blocks_.at(name).before;
  if (config_.has(key) || before.empty()) return value(key);
  if (before == "input") return value("input");
  return look_up(Node{Op::name, 0.0, before, {}, 0}, "chain");
}

/// Multiplies a vertex by the block's gain K, if it has one.
int Reader::with_gain(const std::string& name, int vertex) {
  const std::string key = "blocks." + name + ".K";
  return config_.has(key) ? graph_.make(Act::multiply, value(key), vertex) : vertex;
}

bool Reader::surely_positive(int vertex) const {
  const auto constant = graph_.constants().find(vertex);
  if (constant != graph_.constants().end()) return constant->second > 0.0;
  const Vertex& v = graph_[vertex];
  const int parameter = v.index - kFirstParameter;
  return v.act == Act::coefficient && parameter >= 0 &&
         parameter < static_cast<int>(user_model_.parameters.size()) &&
         user_model_.parameters[static_cast<std::size_t>(parameter)].low > 0.0;
}

/// Applies the limits of a block's output; the limits of a state belong to the state itself (non-windup).
int Reader::limited(const std::string& name, int vertex) {
  const std::string low = "blocks." + name + ".low", high = "blocks." + name + ".high";
  if (!config_.has(low) && !config_.has(high)) return vertex;
  const double far = 1e300;
  return graph_.make(Act::clamp, vertex, value(low, -far), value(high, far));
}

/// Returns the output of a block. Resolves only inputs on which the output depends directly, not through a
/// state, so that a loop through a lag or an integrator is allowed.
int Reader::block_output(const std::string& name) {
  Block& block = blocks_.at(name);
  const std::string key = "blocks." + name + ".";
  if (block.kind == "gain")
    return limited(name, graph_.make(Act::multiply, value(key + "K"), block_input(name)));
  if (block.kind == "deadband")
    return limited(name, graph_.dead_band(block_input(name), value(key + "width")));
  if (block.kind == "transfer_function") {
    transfer_function_states(name, block);
    return named_.at(name).vertex;
  }
  return first_order(name, block);
}

int Reader::first_order(const std::string& name, Block& block) {
  const std::string key = "blocks." + name + ".";
  block.first_state = add_state(name, fmt::format("state of the {} {}", block.kind, name));
  const int state = block.first_state, x = graph_.state(state);
  states_[static_cast<std::size_t>(state)].weight = state_weight(key);
  if (limits_its_state(block.kind)) {
    StateEntry& s = states_[static_cast<std::size_t>(state)];
    if (config_.has(key + "low")) s.low = value(key + "low");
    if (config_.has(key + "high")) states_[static_cast<std::size_t>(state)].high = value(key + "high");
    states_[static_cast<std::size_t>(state)].start = value(key + "start", 0.0);
    const int out = state_value(state);
    if (block.kind == "integrator") return out;
    const int T = value(key + "T");
    if (surely_positive(T)) return out;
    const int passed = with_gain(name, block_input(name));
    const StateEntry& limits = states_[static_cast<std::size_t>(state)];
    const double far = 1e300;
    const int clamped =
        limits.low < 0 && limits.high < 0
            ? passed
            : graph_.make(Act::clamp, passed, limits.low < 0 ? graph_.constant(-far) : limits.low,
                          limits.high < 0 ? graph_.constant(far) : limits.high);
    return graph_.make(Act::select_less, graph_.constant(0.0), graph_.make(Act::inverse, T), out, clamped);
  }
  const int u = block_input(name), zero = graph_.constant(0.0);
  const bool washout = block.kind == "washout";
  const int iT = graph_.make(Act::inverse, value(key + (washout ? "T" : "Tb")));
  const int distance = graph_.make(Act::subtract, u, x);
  int out = -1;
  if (washout) {
    out = graph_.make(Act::select_less, zero, iT, distance, zero);
  } else {
    const int dx = graph_.make(Act::multiply, distance, iT);
    const int ahead = graph_.make(Act::add, x, graph_.make(Act::multiply, value(key + "Ta"), dx));
    out = graph_.make(Act::select_less, zero, iT, ahead, u);
  }
  return limited(name, with_gain(name, out));
}

/// Returns the vertices of a list of expressions.
std::vector<int> Reader::list(const std::string& key) {
  std::vector<int> vertices;
  const auto texts = config_.require<std::vector<std::string>>(key);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    Fault fault;
    const std::string place = fmt::format("{}[{}]", key, i);
    const Tree tree = parse_value(texts[i], fault);
    if (!tree) problem(place, fault.at, fault.what, fault.why, fault.remedy);
    vertices.push_back(tree ? lower(tree, place) : graph_.constant(1.0));
    if (!graph_[vertices.back()].fixed)
      problem(place, 0, "a coefficient that varies during the run",
              "a transfer function is linear and constant",
              "use parameters and values at the operating point");
  }
  return vertices;
}

/// Adds the states of b(s)/a(s) in observer canonical form. Coefficients, by ascending powers of s, are
/// divided by a_n:
///   y = z_n + b_n u,  dz_1 = b_0 u - a_0 y,  dz_i = z_(i-1) + b_(i-1) u - a_(i-1) y
void Reader::transfer_function_states(const std::string& name, Block& block) {
  const std::string key = "blocks." + name + ".";
  constexpr std::size_t kHighest = 10;
  auto b = list(key + "numerator"), a = list(key + "denominator");
  Named& entry = named_.at(name);
  if (a.size() < 2 || a.size() > kHighest + 1 || b.empty() || b.size() > a.size()) {
    if (config_.has(key + "numerator") && config_.has(key + "denominator"))
      problem(key + "denominator", 0,
              fmt::format("a transfer function with {} over {} coefficients", b.size(), a.size()),
              fmt::format("the denominator has 2 to {} coefficients, the numerator at most as many",
                          kHighest + 1),
              "give coefficients in rising powers of s");
    entry.vertex = graph_.constant(0.0);
    return;
  }
  const std::size_t n = a.size() - 1;
  b.resize(n + 1, graph_.constant(0.0));
  const int leading = a[n];
  for (auto* v : {&a, &b})
    for (int& c : *v) c = graph_.make(Act::divide, c, leading);
  block.first_state = static_cast<int>(states_.size());
  for (std::size_t i = 1; i <= n; ++i)
    add_state(fmt::format("{}_{}", name, i), fmt::format("state {} of the transfer function {}", i, name));
  const int last = graph_.state(block.first_state + static_cast<int>(n) - 1);
  const auto through = graph_.constants().find(b[n]);
  const bool strictly_proper = config_.require<std::vector<std::string>>(key + "numerator").size() <= n ||
                               (through != graph_.constants().end() && through->second == 0.0);
  int y = last;
  if (strictly_proper)
    entry.vertex = limited(name, y);  // independent of the input, so that loops are allowed
  const int u = block_input(name);
  if (!strictly_proper) y = graph_.make(Act::add, last, graph_.make(Act::multiply, b[n], u));
  for (std::size_t i = 0; i < n; ++i) {
    const int state = block.first_state + static_cast<int>(i);
    int dz =
        graph_.make(Act::subtract, graph_.make(Act::multiply, b[i], u), graph_.make(Act::multiply, a[i], y));
    if (i > 0) dz = graph_.make(Act::add, graph_.state(state - 1), dz);
    states_[static_cast<std::size_t>(state)].derivative = dz;
  }
  if (!strictly_proper) entry.vertex = limited(name, y);
}

/// Sets the derivative of a block's state after its output has been resolved.
void Reader::finish_block(const std::string& name) {
  const Node self{Op::name, 0.0, name, {}, 0};
  (void)named(self, "blocks." + name, named_.at(name));
  Block& block = blocks_.at(name);
  const std::string key = "blocks." + name + ".";
  if (block.first_state < 0 || block.kind == "transfer_function") return;
  const int u = block_input(name), x = graph_.state(block.first_state);
  int dx = -1;
  if (block.kind == "integrator") {
    dx = with_gain(name, u);
  } else {
    const bool lag = block.kind == "lag";
    const int target = lag ? with_gain(name, u) : u;
    const int iT = graph_.make(Act::inverse, value(key + (block.kind == "lead_lag" ? "Tb" : "T")));
    dx = graph_.make(Act::multiply, graph_.make(Act::subtract, target, x), iT);
  }
  states_[static_cast<std::size_t>(block.first_state)].derivative = dx;
}

}  // namespace swingbank::sim::user_models
