// Back-initialisation of one plant with its controls, from the voltage of its bus and its generation.
#include <fmt/format.h>

#include <cmath>

#include "sim/plant/equations.hpp"
#include "sim/plant/parameter_id.hpp"

namespace swingbank::sim::plant {
namespace {

/// A block, its parameters, and the positions of its coefficients and states.
template <class T>
struct Place {
  const Effect* effect;
  const T* p;
  std::size_t c, x;
};

template <class T>
class Initialiser {
 public:
  Initialiser(const Plant& plant, const std::vector<std::vector<T>>& parameters, Complex voltage, const T& P,
              const T& Q, const Conventions& conventions)
      : plant_(plant), equations_(plant) {
    o_.c.assign(static_cast<std::size_t>(equations_.coefficients()), T(0.0));
    o_.x.assign(static_cast<std::size_t>(equations_.states()), T(0.0));
    scratch_.assign(static_cast<std::size_t>(equations_.scratch()), T(0.0));
    std::size_t c = 0, x = 0, block = 0;
    const auto add = [&](const Block& b, std::size_t more) {
      places_.push_back({b.effect, parameters[block++].data(), c, x});
      c += static_cast<std::size_t>(b.effect->coefficients) + more;
      x += b.effect->states.size();
    };
    add(plant.machine, kJoint);
    if (plant.transformer.effect) transformer_ = parameters[block++].data();
    for (const Block& control : plant.controls) add(control, 0);
    Conventions here = conventions;
    here.mva = plant.mva;
    for (const auto& p : places_) ops(p).prepare(p.p, here, o_.c.data() + p.c);
    join();
    terminal(voltage, P, Q);
  }

  OperatingOf<T> run() {
    const auto& machine = places_.front();
    add_problem(ops(machine).machine.steady(machine.p, coefficients(machine), o_.s, states(machine)),
                machine);
    o_.Efd = o_.s.Efd;
    o_.Tm = o_.s.Tm;
    emf();
    ops(machine).machine.electrical(coefficients(machine), states(machine), scratch_.data(), o_.s);
    if (machine.effect->converter)
      converter_controls();
    else
      for (std::size_t i = 1; i < places_.size(); ++i) add_problem(steady(places_[i]), places_[i]);
    problems_.raise();
    within_limits();
    check_steady();
    problems_.raise();
    return std::move(o_);
  }

 private:
  static const Ops<T>& ops(const Place<T>& p) { return p.effect->template get<T>(); }
  T* coefficients(const Place<T>& p) { return o_.c.data() + p.c; }
  T* states(const Place<T>& p) { return o_.x.data() + p.x; }
  [[nodiscard]] std::string where() const { return "generator " + plant_.name; }

  /// Sets the plant's own coefficients (Joint): impedances of machine and step-up transformer.
  void join() {
    T* j = o_.c.data() + plant_.machine.effect->coefficients;
    ops(places_.front()).machine.source_impedance(places_.front().p, j[joint_rm], j[joint_xm]);
    j[joint_ratio] = T(1.0);
    j[joint_r] = j[joint_rm];
    j[joint_x] = j[joint_xm];
    if (!transformer_) return;
    T r, x;
    plant_.transformer.effect->template get<T>().transformer.impedance(transformer_, r, x, j[joint_ratio]);
    const T square_ratio = j[joint_ratio] * j[joint_ratio];
    j[joint_r] = square_ratio * (j[joint_rm] + r);
    j[joint_x] = square_ratio * (j[joint_xm] + x);
  }
  std::string steady(const Place<T>& p) {
    return ops(p).control.steady(p.effect->user_model.get(), p.p, coefficients(p), o_.s, states(p));
  }
  /// Initialises converter controls backwards from the current: the electrical control determines the
  /// references of the plant control. A second pass gives the drive train the speed reference of the torque
  /// control, which is initialised after the drive train.
  void converter_controls() {
    o_.s.Pneed = o_.s.P;
    o_.s.Qneed = o_.s.Q;
    const Signals<T> first = o_.s;
    for (const bool last : {false, true}) {
      const T wt = o_.s.wt, wg = o_.s.wg, wref = o_.s.wref, pitch = o_.s.pitch;
      o_.s = first;
      o_.s.wt = wt;
      o_.s.wg = wg;
      o_.s.wref = wref;
      o_.s.pitch = pitch;
      for (std::size_t i = places_.size(); --i > 0;) {
        const std::string why = steady(places_[i]);
        if (last) add_problem(why, places_[i]);
      }
    }
  }
  void terminal(Complex v, const T& P, const T& Q) {
    Signals<T>& s = o_.s;
    s.Vr = s.Vpr = T(v.real());
    s.Vi = s.Vpi = T(v.imag());
    const T per_square(1.0 / std::norm(v));
    s.Ir = (s.Vr * P + s.Vi * Q) * per_square;
    s.Ii = (s.Vi * P - s.Vr * Q) * per_square;
    equations_.look_far(s, s.Vr, s.Vi, s.Ir, s.Ii);
    if (plant_.far) {
      const Far<double>& f = *plant_.far;
      s.far = {T(f.Vr), T(f.Vi), T(f.Ir), T(f.Ii), T(f.P), T(f.Q)};
    }
    if (transformer_) equations_.through_transformer(o_.c.data(), s);
    using std::sqrt;
    s.V = s.Vc = sqrt(s.Vr * s.Vr + s.Vi * s.Vi);
    s.P = s.Vr * s.Ir + s.Vi * s.Ii;
    s.Q = s.Vi * s.Ir - s.Vr * s.Ii;
  }
  void add_problem(const std::string& why, const Place<T>& p) {
    if (why.empty()) return;
    const Signals<T>& s = o_.s;
    problems_.add(fmt::format("{} has no steady state at P = {:.4f} pu, Q = {:.4f} pu, V = {:.4f} pu",
                              p.effect->name, value_of(s.P), value_of(s.Q), value_of(s.V)),
                  where(), why, "change the model's parameters or the dispatch");
  }
  /// Checks that the voltage behind the impedance produces exactly the current of the power flow.
  void emf() {
    T er, ei;
    const T* j = o_.c.data() + plant_.machine.effect->coefficients;
    ops(places_.front())
        .machine.emf(coefficients(places_.front()), states(places_.front()), scratch_.data(), er, ei);
    Signals<T> again = o_.s;
    if (equations_.nonlinear()) {
      equations_.current(o_.c.data(), o_.x.data(), scratch_.data(), again);
    } else {
      const Complex z(value_of(j[joint_rm]), value_of(j[joint_xm]));
      const Complex i =
          (Complex(value_of(er), value_of(ei)) - Complex(value_of(o_.s.Vr), value_of(o_.s.Vi))) / z;
      again.Ir = T(i.real());
      again.Ii = T(i.imag());
    }
    const double gap =
        std::hypot(value_of(again.Ir) - value_of(o_.s.Ir), value_of(again.Ii) - value_of(o_.s.Ii));
    if (!(gap * std::hypot(value_of(j[joint_rm]), value_of(j[joint_xm])) < kTolerance))
      problems_.add(fmt::format("terminal current differs by {:.3g} pu", gap), where(),
                    std::string(plant_.machine.effect->name) + " does not reproduce the operating point",
                    "check its parameters");
  }
  void within_limits() {
    for (const auto& p : places_)
      for (std::size_t k = 0; k < p.effect->states.size(); ++k) {
        const State& state = p.effect->states[k];
        const double x = value_of(o_.x[p.x + k]);
        const auto outside = [&](int limit, const char* side, bool wrong) {
          if (!wrong) return;
          problems_.add(fmt::format("{} of {} = {:.4g} {}", state.name, p.effect->name, x, state.unit),
                        where(),
                        fmt::format("its {} limit is {:.4g} {}", side,
                                    value_of(o_.c[p.c + static_cast<std::size_t>(limit)]), state.unit),
                        "widen the limit or change the dispatch");
        };
        const auto limit = [&](int index) { return value_of(o_.c[p.c + static_cast<std::size_t>(index)]); };
        if (state.low >= 0) outside(state.low, "lower", x < limit(state.low) - kTolerance);
        if (state.high >= 0) outside(state.high, "upper", x > limit(state.high) + kTolerance);
      }
  }
  /// Checks that the controls' Efd and Tm equal the machine's, and that every derivative is zero.
  void check_steady() {
    std::vector<T> dx(o_.x.size(), T(0.0));
    Signals<T> s = o_.s;
    s.Efd = o_.Efd;
    s.Tm = o_.Tm;
    s.t = T(-1.0);  // before any time-dependent action
    equations_.derivative(o_.c.data(), o_.x.data(), scratch_.data(), s, dx.data());
    const auto off = [&](const char* signal, const char* models, const T& is, const T& should) {
      if (!(std::abs(value_of(is) - value_of(should)) < kTolerance))
        problems_.add(fmt::format("{} = {:.6g} pu", signal, value_of(is)), where(),
                      fmt::format("the machine needs {:.6g} pu at its operating point", value_of(should)),
                      fmt::format("check the limits of the {}", models));
    };
    off("Efd", "exciter or electrical control", s.Efd, o_.Efd);
    off("Tm", "governor or electrical control", s.Tm, o_.Tm);
    for (const auto& p : places_)
      for (std::size_t k = 0; k < p.effect->states.size(); ++k)
        if (!(std::abs(value_of(dx[p.x + k])) < kTolerance))
          problems_.add(fmt::format("state {} of {} changes by {:.3g} per second", p.effect->states[k].name,
                                    p.effect->name, value_of(dx[p.x + k])),
                        where(), "derivatives at the operating point must be below 1e-9",
                        "check the model's parameters");
  }

  static constexpr double kTolerance = 1e-9;  // [pu, 1/s]; the rounding error is about 1e-14
  const Plant& plant_;
  PlantEquations<T> equations_;
  std::vector<Place<T>> places_;
  const T* transformer_ = nullptr;
  std::vector<T> scratch_;
  OperatingOf<T> o_{};
  Problems problems_;
};

}  // namespace

template <class T>
OperatingOf<T> operating_point_of(const Plant& plant, const std::vector<std::vector<T>>& parameters,
                                  Complex voltage, double base_mva, const Conventions& conventions) {
  const Complex power = plant.generation * (base_mva / plant.mva);
  return operating_point_of<T>(plant, parameters, voltage, T(power.real()), T(power.imag()), conventions);
}
template <class T>
OperatingOf<T> operating_point_of(const Plant& plant, const std::vector<std::vector<T>>& parameters,
                                  Complex voltage, const T& P, const T& Q, const Conventions& conventions) {
  return Initialiser<T>(plant, parameters, voltage, P, Q, conventions).run();
}
template OperatingOf<double> operating_point_of(const Plant&, const std::vector<std::vector<double>>&,
                                                Complex, double, const Conventions&);
template OperatingOf<D8> operating_point_of(const Plant&, const std::vector<std::vector<D8>>&, Complex,
                                            double, const Conventions&);
template OperatingOf<double> operating_point_of(const Plant&, const std::vector<std::vector<double>>&,
                                                Complex, const double&, const double&, const Conventions&);
template OperatingOf<D8> operating_point_of(const Plant&, const std::vector<std::vector<D8>>&, Complex,
                                            const D8&, const D8&, const Conventions&);

Operating operating_point(const Plant& plant, Complex voltage, double base_mva,
                          const Conventions& conventions) {
  return operating_point_of<double>(plant, block_parameters(plant), voltage, base_mva, conventions);
}

}  // namespace swingbank::sim::plant
