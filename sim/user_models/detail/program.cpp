#include "sim/user_models/detail/program.hpp"

#include <algorithm>

namespace swingbank::sim::user_models {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// A value to store: (vertex, index of the target).
using Store = std::pair<int, int>;

/// Orders the vertices needed by the stores and assigns registers to them.
class Emitter {
 public:
  /// `known`: coefficient of vertices that need no computation, else -1.
  Emitter(const Graph& graph, const std::vector<int>& known) : graph_(graph), known_(known) {}

  Code emit(const std::vector<Store>& stores) {
    const std::size_t n = graph_.vertices().size();
    last_.assign(n, -1);
    register_.assign(n, -1);
    for (const auto& [vertex, index] : stores) last_[at(vertex)] = vertex;
    for (int v = static_cast<int>(n) - 1; v >= 0; --v) {  // operands precede their users
      if (last_[at(v)] < 0 || loaded(v)) continue;
      for (const int from : graph_[v].from)
        if (from >= 0) last_[at(from)] = std::max(last_[at(from)], v);
    }
    for (int i = kRegisters - 1; i >= 0; --i) free_.push_back(i);
    for (int v = 0; v < static_cast<int>(n); ++v) {
      if (last_[at(v)] < 0) continue;
      compute(v);
      for (const auto& [vertex, index] : stores)
        if (vertex == v) code_.push_back({Act::store, 0, {place(v)}, static_cast<std::int16_t>(index)});
      if (last_[at(v)] == v) free_.push_back(register_[at(v)]);
    }
    return std::move(code_);
  }

 private:
  [[nodiscard]] bool loaded(int v) const { return known_[at(v)] >= 0 || graph_[v].act <= Act::signal; }
  [[nodiscard]] std::uint8_t place(int v) const { return static_cast<std::uint8_t>(register_[at(v)]); }
  /// Emits the instruction of a vertex. The result gets its register before the operands' registers are
  /// released, so that no instruction overwrites its own operands.
  void compute(int v) {
    const Vertex& vertex = graph_[v];
    const int known = known_[at(v)];
    Instruction i{known >= 0 ? Act::coefficient : vertex.act};
    i.index = static_cast<std::int16_t>(known >= 0 ? known : vertex.index);
    if (!loaded(v))
      for (std::size_t k = 0; k < vertex.from.size(); ++k)
        if (vertex.from[k] >= 0) i.from[k] = place(vertex.from[k]);
    if (free_.empty()) throw TooLarge{};
    register_[at(v)] = free_.back();
    free_.pop_back();
    i.to = place(v);
    code_.push_back(i);
    if (loaded(v)) return;
    auto operands = vertex.from;
    std::ranges::sort(operands);
    for (std::size_t k = 0; k < operands.size(); ++k) {
      const bool again = k > 0 && operands[k] == operands[k - 1];
      if (operands[k] >= 0 && !again && last_[at(operands[k])] == v)
        free_.push_back(register_[at(operands[k])]);
    }
  }

  const Graph& graph_;
  const std::vector<int>& known_;
  std::vector<int> last_, register_, free_;
  Code code_;
};

/// Returns a mask of the fixed vertices that the loop reads directly.
std::vector<char> frontier(const Graph& graph, const std::vector<int>& roots) {
  const std::size_t n = graph.vertices().size();
  std::vector<char> needed(n, 0), fixed(n, 0);
  for (const int v : roots) needed[at(v)] = 1;
  for (int v = static_cast<int>(n) - 1; v >= 0; --v) {
    if (needed[at(v)] == 0) continue;
    fixed[at(v)] = graph[v].fixed ? 1 : 0;
    if (graph[v].fixed) continue;
    for (const int from : graph[v].from)
      if (from >= 0) needed[at(from)] = 1;
  }
  return fixed;
}

}  // namespace

Compiled compile(const Graph& graph, const std::vector<int>& derivatives, int output,
                 const std::vector<int>& also, int first) {
  constexpr int kMostCoefficients = 10000;  // fits the 16-bit index of an instruction
  Compiled out;
  const int n = static_cast<int>(graph.vertices().size());
  std::vector<int> roots = derivatives;
  roots.push_back(output);
  std::vector<char> wanted = frontier(graph, roots);
  for (const int v : also) wanted[at(v)] = 1;
  out.coefficients = first;
  std::vector<int> given(at(n), -1);  // coefficients that are not computed
  for (int v = 0; v < n; ++v) {
    if (graph[v].act != Act::coefficient) continue;
    given[at(v)] = graph[v].index;
    if (graph[v].index >= 0) continue;
    out.constants.emplace_back(out.coefficients, graph.constants().at(v));
    given[at(v)] = out.coefficients++;
  }
  out.coefficient_of = given;
  std::vector<Store> stores;
  for (int v = 0; v < n; ++v)
    if (wanted[at(v)] != 0 && given[at(v)] < 0) {
      stores.emplace_back(v, out.coefficients);
      out.coefficient_of[at(v)] = out.coefficients++;
    }
  if (out.coefficients > kMostCoefficients) throw TooLarge{};
  out.fixed = Emitter(graph, given).emit(stores);
  stores.clear();
  for (std::size_t i = 0; i < derivatives.size(); ++i)
    stores.emplace_back(derivatives[i], static_cast<int>(i));
  stores.emplace_back(output, -1);
  out.loop = Emitter(graph, out.coefficient_of).emit(stores);
  return out;
}

}  // namespace swingbank::sim::user_models
