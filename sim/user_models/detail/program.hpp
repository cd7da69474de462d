#pragma once
// Register program of a user-defined model's graph: one instruction list fills the coefficients once for each
// simulation, a second list evaluates the derivatives. No branch depends on a value of type T, and execution
// allocates no memory.
#include <cstdint>
#include <vector>

#include "sim/core/blocks.hpp"
#include "sim/user_models/detail/graph.hpp"

namespace swingbank::sim::user_models {

/// One instruction: registers of the result and of the operands, and an index.
struct Instruction {
  Act act;
  std::uint8_t to = 0;
  std::array<std::uint8_t, 4> from = {};
  std::int16_t index = -1;  ///< index of the coefficient, state or signal, or the target of Act::store
};
using Code = std::vector<Instruction>;

constexpr int kRegisters = 64;

/// Executes `code` on coefficients c, states x and signals s. Act::store writes out[index], or `last` if the
/// index is -1. r: kRegisters registers. If `Free`, Act::limit does not clamp.
template <class T, bool Free>
void run(const Code& code, const T* c, const T* x, const Signals<T>& s, T* r, T* out, T& last) {
  using std::exp;
  using std::log;
  using std::sqrt;
  for (const Instruction& i : code) {
    const T& a = r[i.from[0]];
    const T& b = r[i.from[1]];
    T& to = r[i.to];
    switch (i.act) {
      case Act::coefficient:
        to = c[i.index];
        break;
      case Act::state:
        to = x[i.index];
        break;
      case Act::signal:
        to = s.*kMembers<T>[static_cast<std::size_t>(i.index)];
        break;
      case Act::add:
        to = a + b;
        break;
      case Act::subtract:
        to = a - b;
        break;
      case Act::multiply:
        to = a * b;
        break;
      case Act::divide:
        to = a / b;
        break;
      case Act::minimum:
        to = select(b < a, b, a);
        break;
      case Act::maximum:
        to = select(a < b, b, a);
        break;
      case Act::square_root:
        to = sqrt(a);
        break;
      case Act::exponential:
        to = exp(a);
        break;
      case Act::logarithm:
        to = log(a);
        break;
      case Act::sine: {
        T cosine;
        sincos(T(a), to, cosine);
        break;
      }
      case Act::cosine: {
        T sine;
        sincos(T(a), sine, to);
        break;
      }
      case Act::clamp:
        to = clamp(T(a), T(b), r[i.from[2]]);
        break;
      case Act::limit:
        to = Free ? T(a) : clamp(T(a), T(b), r[i.from[2]]);
        break;
      case Act::inverse:
        to = inverse(T(a));
        break;
      case Act::select_less:
        to = select(a < b, r[i.from[2]], r[i.from[3]]);
        break;
      case Act::select_less_equal:
        to = select(a <= b, r[i.from[2]], r[i.from[3]]);
        break;
      case Act::store:
        (i.index < 0 ? last : out[i.index]) = a;
        break;
    }
  }
}

/// Uninitialised storage for the registers; avoids the cost of clearing them.
template <class T>
class Registers {
 public:
  T* data() { return reinterpret_cast<T*>(storage_); }

 private:
  alignas(64) std::byte storage_[sizeof(T) * kRegisters];
};

/// Compiled graph.
struct Compiled {
  Code fixed;                                     ///< computes coefficients
  Code loop;                                      ///< computes derivatives, and the output as the last value
  std::vector<int> coefficient_of;                ///< of each vertex: index of its coefficient, or -1
  std::vector<std::pair<int, double>> constants;  ///< coefficient index, value
  int coefficients = 0;
};

/// Compiles a graph. `derivatives`, `output`: vertices that the loop evaluates; `also`: further fixed
/// vertices that need a coefficient; `first`: number of coefficients already in use. Throws TooLarge if the
/// program needs too many registers or coefficients.
Compiled compile(const Graph& graph, const std::vector<int>& derivatives, int output,
                 const std::vector<int>& also, int first);

}  // namespace swingbank::sim::user_models
