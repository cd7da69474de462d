#pragma once
// A law's graph as two flat lists of instructions over a few registers: one for what is fixed during a run
// (it fills coefficients), one for the loop. No branch depends on a T, nothing is allocated.
#include <cstdint>
#include <vector>

#include "sim/core/blocks.hpp"
#include "sim/laws/detail/graph.hpp"

namespace swingbank::sim::laws {

struct Instruction {
  Act act;
  std::uint8_t to = 0;
  std::array<std::uint8_t, 4> from = {};
  std::int16_t index = -1;  ///< of coefficient, state, signal, or of what Act::store writes
};
using Code = std::vector<Instruction>;

constexpr int kRegisters = 64;

/// Runs `code` over coefficients c, states x and signals s; Act::store writes out[index], or `last` where the
/// index is -1. r: room for kRegisters. `Free`: states are not held to their limits.
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

/// Room for registers without the cost of clearing them.
template <class T>
class Registers {
 public:
  T* data() { return reinterpret_cast<T*>(room_); }

 private:
  alignas(64) std::byte room_[sizeof(T) * kRegisters];
};

struct Compiled {
  Code fixed;                                     ///< stores coefficients
  Code loop;                                      ///< stores derivatives, and the output as the last
  std::vector<int> coefficient_of;                ///< per vertex: where its value stands during a run, or -1
  std::vector<std::pair<int, double>> constants;  ///< coefficient index, value
  int coefficients = 0;
};

/// Compiles a graph. `derivatives`, `output`: vertices whose values the loop gives; `also`: further fixed
/// vertices that must get a coefficient; `first`: number of coefficients already taken. Throws TooLarge.
Compiled compile(const Graph& graph, const std::vector<int>& derivatives, int output,
                 const std::vector<int>& also, int first);

}  // namespace swingbank::sim::laws
