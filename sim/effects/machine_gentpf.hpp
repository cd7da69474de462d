#pragma once
// GENTPF: GENTPJ with saturation independent of the stator current.
#include "sim/effects/machine_gentpj.hpp"

namespace swingbank::sim::effects::machine_gentpf {

struct Model {
  using B = machine_gentpj::Model;
  static constexpr std::string_view
      name = "GENTPF",
      title = "synchronous machine, saturation of every inductance by flux",
      source =
          "J. Weber, Description of machine models GENROU, GENSAL, GENTPF and GENTPJ (PowerWorld, 2015): "
          "GENTPJ with Kis = 0",
      dyr_name = "GENTPF";
  static constexpr Slot slot = Slot::machine;
  static constexpr std::string_view description = R"(
  GENTPJ with Kis = 0: u, the flux that saturation depends on, is that of the air gap alone.
)";
  /// The parameters of GENTPJ without Kis.
  static constexpr int kWithoutKis = B::Ra;
  static constexpr auto kParameters = [] {
    std::array<Parameter, kWithoutKis> all{};
    for (int i = 0; i < B::Kis; ++i) all[static_cast<std::size_t>(i)] = B::parameters[i];
    all[B::Kis] = B::parameters[B::Ra];
    return all;
  }();
  static constexpr std::span<const Parameter> parameters = kParameters;
  static constexpr Source defaults_from = B::defaults_from, bounds_from = B::bounds_from;
  static constexpr std::span<const State> states{B::states};
  static constexpr std::span<const int> dyr_columns{B::dyr_columns, static_cast<std::size_t>(B::Kis)};
  static constexpr int raw_resistance = B::Kis, raw_reactance = -1;
  static constexpr int coefficients = B::coefficients, scratch = B::scratch;

  template <class T>
  static std::array<T, kWithoutKis + 1> as_gentpj(const T* p) {
    std::array<T, kWithoutKis + 1> q;
    for (int i = 0; i < B::Kis; ++i) q[static_cast<std::size_t>(i)] = p[i];
    q[B::Kis] = T(0.0);
    q[B::Ra] = p[B::Kis];
    return q;
  }
  static void check(const double* p, const std::string& where, Problems& problems) {
    const auto q = as_gentpj(p);
    B::check_with({name, B::parameters, q.data(), where, problems}, q.data());
  }
  static std::string_view unphysical(const double* p) { return B::unphysical(as_gentpj(p).data()); }

  template <class T>
  static void prepare(const T* p, const Conventions& conventions, T* c) {
    B::prepare(as_gentpj(p).data(), conventions, c);
  }
  template <class T>
  static void source_impedance(const T* p, T& r, T& x) {
    B::source_impedance(as_gentpj(p).data(), r, x);
  }
  template <class T>
  static void emf(const T* c, const T* x, T* m, T& er, T& ei) {
    B::emf(c, x, m, er, ei);
  }
  template <class T>
  static void current(const T* c, const T* x, T* m, Signals<T>& s) {
    B::current(c, x, m, s);
  }
  template <class T>
  static void electrical(const T* c, const T* x, T* m, Signals<T>& s) {
    B::electrical(c, x, m, s);
  }
  template <class T>
  static void derivative(const T* c, const T* x, const T* m, const Signals<T>& s, T* dx) {
    B::derivative(c, x, m, s, dx);
  }
  template <class T>
  static std::string steady(const T* p, T* c, Signals<T>& s, T* x) {
    return B::steady(as_gentpj(p).data(), c, s, x);
  }
};

}  // namespace swingbank::sim::effects::machine_gentpf
