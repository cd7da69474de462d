// Back-initialisation of one modelled load from its bus voltage and power.
#include <fmt/format.h>

#include <cmath>

#include "sim/plant/load_equations.hpp"

namespace swingbank::sim::plant {
namespace {

/// Returns the source impedance of a load. Any value gives exact results; with the impedance at the operating
/// point, a constant-impedance load has E = 0. A load with nearly zero current, such as a compensator in the
/// middle of its range, gets 1e3 pu.
Complex source_impedance(Complex voltage, Complex current) {
  constexpr double largest = 1e3;  // largest source impedance [pu]
  return std::abs(current) * largest > std::abs(voltage) ? -voltage / current : Complex(0.0, largest);
}

}  // namespace

template <class T>
OperatingOf<T> load_operating_point(const Consumer& load, const std::vector<T>& parameters, Complex voltage,
                                    double base_mva, const Conventions& conventions,
                                    std::optional<Complex> regulated) {
  constexpr double tolerance = 1e-9;  // [pu, 1/s]; the rounding error is about 1e-14
  const LoadEquations<T> equations(load);
  const Effect& effect = *load.block.effect;
  OperatingOf<T> o{};
  o.c.assign(static_cast<std::size_t>(equations.coefficients()), T(0.0));
  o.x.assign(static_cast<std::size_t>(equations.states()), T(0.0));
  Conventions here = conventions;
  here.mva = load.mva;
  effect.get<T>().prepare(parameters.data(), here, o.c.data());
  const Complex power = load.consumption * (base_mva / load.mva), current = -std::conj(power / voltage);
  const Complex watched = regulated.value_or(voltage);
  o.s.Vr = T(voltage.real());
  o.s.Vi = T(voltage.imag());
  o.s.V = T(std::abs(voltage));
  o.s.Vpr = T(watched.real());
  o.s.Vpi = T(watched.imag());
  o.s.Vp = T(std::abs(watched));
  o.s.Ir = T(current.real());
  o.s.Ii = T(current.imag());
  const Complex z = source_impedance(voltage, current);
  T* joint = o.c.data() + effect.coefficients;
  joint[load_r] = T(z.real());
  joint[load_x] = T(z.imag());

  Problems problems;
  const std::string where = "load " + load.name;
  const auto refuse = [&](const std::string& why) {
    problems.add(fmt::format("{} has no steady state at P = {:.4f} pu, Q = {:.4f} pu, V = {:.4f} pu",
                             effect.name, power.real(), power.imag(), std::abs(voltage)),
                 where, why, "change the model's parameters or the load");
  };
  if (const std::string why = effect.get<T>().load.steady(parameters.data(), o.c.data(), o.s, o.x.data());
      !why.empty())
    refuse(why);
  problems.raise();
  Signals<T> s = o.s;
  equations.current(o.c.data(), o.x.data(), s);
  const double gap = std::hypot(value_of(s.Ir) - current.real(), value_of(s.Ii) - current.imag());
  if (!(gap < tolerance)) refuse(fmt::format("its current would differ by {:.3g} pu", gap));
  std::vector<T> dx(o.x.size(), T(0.0));
  equations.derivative(o.c.data(), o.x.data(), s, dx.data());
  for (std::size_t k = 0; k < dx.size(); ++k)
    if (!(std::abs(value_of(dx[k])) < tolerance))
      refuse(fmt::format("state {} changes by {:.3g} per second", effect.states[k].name, value_of(dx[k])));
  problems.raise();
  return o;
}
template OperatingOf<double> load_operating_point(const Consumer&, const std::vector<double>&, Complex,
                                                  double, const Conventions&, std::optional<Complex>);
template OperatingOf<D8> load_operating_point(const Consumer&, const std::vector<D8>&, Complex, double,
                                              const Conventions&, std::optional<Complex>);

}  // namespace swingbank::sim::plant
