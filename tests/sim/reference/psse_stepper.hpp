#pragma once
// Integrates Swingbank's equations by PSS/E's method, as inferred from its records. Remaining differences
// between record and equations are then due to modelling.
//   x(t + h) = x(t) + h (3 f(t) - f(t - h))/2, at a switching time f is the mean of the derivatives before
//     and after it;
//   some exciters take substeps of the same kind, with all else constant;
//   Efd follows from the exciter's states at t, and voltage and field current at t - h;
//   HYGOV's power, not TGOV1's, is that of t - h;
//   a state at its limit has no past derivative;
//   states are kept in single precision;
//   the network is that of psse_network.hpp.
#include <vector>

#include "sim/reference/detail/system.hpp"
#include "tests/sim/reference/psse_network.hpp"

namespace swingbank::sim::test {

class PsseStepper {
 public:
  PsseStepper(const grid::Grid& grid, const network::Event& event, double h, double end, int exciter_steps,
              double tolerance)
      : h_(h),
        exciter_steps_(exciter_steps),
        plants_(grid),
        parts_(network::segments(event, grid.network, plants_.switching_times())),
        before_(grid, plants_, parts_.at(0), 2 * end),
        after_(grid, plants_, parts_.at(1), 2 * end),
        network_before_(grid, before_, tolerance),
        network_after_(grid, after_, tolerance),
        system_(&before_),
        network_(&network_before_),
        states_(static_cast<std::size_t>(plants_.states())),
        y_(static_cast<std::size_t>(before_.size())),
        f_(y_),
        f_before_(y_),
        fine_f_before_(y_) {
    if (parts_.size() < 2 || (parts_.size() > 2 && parts_[2].start <= end))
      throw std::runtime_error("one switching instant is expected");
    for (const auto& unit : plants_.units())
      std::copy(unit.operating.x.begin(), unit.operating.x.end(), y_.begin() + unit.first);
    for (std::size_t b = 0; b < grid.flow.voltage.size(); ++b) {
      y_[states_ + 2 * b] = grid.flow.voltage[b].real();
      y_[states_ + 2 * b + 1] = grid.flow.voltage[b].imag();
    }
    last_ = y_;
    for (std::size_t u = 0; u < plants_.units().size(); ++u) find_controls(u);
  }
  [[nodiscard]] long switching() const { return std::lround(parts_[1].start / h_); }

  /// Solves the network at t and stores the derivatives of the states.
  void derive(double t) {
    network_->solve(t, y_);
    system_->derivatives(t, y_.data(), f_.data());
    for (const Exciter& e : exciters_)
      f_[e.flux] += (late_field_voltage(e, t) - signals(e.unit, t).Efd) / e.time_constant;
    for (Governor& g : late_governors_) {
      g.now = signals(g.unit, t).Tm;
      f_[g.speed] += (g.last - g.now) / (1.0 + y_[g.speed]) / (2.0 * g.inertia);
    }
  }
  /// Switches to the network after the event; stores the mean of the derivatives before and after it.
  void switch_over(double t) {
    const auto f = f_;
    system_ = &after_;
    network_ = &network_after_;
    derive(t);
    for (std::size_t i = 0; i < states_; ++i) f_[i] = 0.5 * (f_[i] + f[i]);
  }
  /// Integrates from t to t + h.
  void advance(double t) {
    const auto at_t = y_;
    const auto exciters = advanced_exciters(t);
    for (std::size_t i = 0; i < states_; ++i) y_[i] += h_ * (1.5 * f_[i] - 0.5 * f_before_[i]);
    for (const Exciter& e : exciters_)
      for (std::size_t i = e.first; i < e.end; ++i) y_[i] = exciters[i];
    f_before_ = f_;
    clamp(y_, f_before_);
    for (Governor& g : late_governors_) g.last = g.now;
    for (std::size_t i = 0; i < states_; ++i) y_[i] = static_cast<float>(y_[i]);
    last_ = at_t;
  }
  /// Printed quantities of a plant at t, as in PSS/E.
  [[nodiscard]] Signals<double> printed(std::size_t plant, double t) const {
    auto s = signals(plant, t);
    for (const Exciter& e : exciters_)
      if (e.unit == plant) s.Efd = late_field_voltage(e, t);
    return s;
  }
  [[nodiscard]] const double* states(std::size_t plant) const {
    return y_.data() + plants_.units()[plant].first;
  }
  /// Real and imaginary voltage of every bus [pu].
  [[nodiscard]] const double* voltages() const { return y_.data() + states_; }

 private:
  struct Exciter {
    std::size_t unit, first, end;  ///< indices of its states
    std::size_t flux;              ///< index of E'q, whose input is Efd
    double time_constant;          ///< the T'do of its equation [s]
  };
  struct Governor {
    std::size_t unit, speed;  ///< index of the speed deviation
    double inertia;           ///< H [s]
    double last, now;         ///< power at t - h and t [pu]
  };
  void find_controls(std::size_t u) {
    const auto& unit = plants_.units()[u];
    if (!unit.plant) return;
    const plant::Block& machine = unit.plant->machine;
    auto place = static_cast<std::size_t>(unit.first);
    Exciter e{u, 0, 0, 0, 0.0};
    for (std::size_t i = 0; i < machine.effect->states.size(); ++i, ++place)
      if (machine.effect->states[i].name == "Eqp") e.flux = place;
    const auto parameter = [&](const char* name) {
      return machine.p.at(static_cast<std::size_t>(machine.effect->parameter_index(name)));
    };
    for (const plant::Block& block : unit.plant->controls) {
      if (block.effect->slot == Slot::exciter) {
        e.first = place;
        e.end = place + block.effect->states.size();
        e.time_constant = parameter("Tdop");
        exciters_.push_back(e);
      }
      if (block.effect->name == "HYGOV")
        late_governors_.push_back({u, static_cast<std::size_t>(unit.first) + 1, parameter("H"),
                                   unit.operating.Tm, unit.operating.Tm});
      place += block.effect->states.size();
    }
  }
  [[nodiscard]] Signals<double> signals(std::size_t unit, double t) const {
    Complex current;
    return system_->signals(unit, t, y_.data(), current);
  }
  [[nodiscard]] double late_field_voltage(const Exciter& e, double t) const {
    auto mixed = last_;
    for (std::size_t i = e.first; i < e.end; ++i) mixed[i] = y_[i];
    Complex current;
    return system_->signals(e.unit, t, mixed.data(), current).Efd;
  }
  /// Clamps states at their limits; a clamped state has no past derivative.
  void clamp(std::vector<double>& y, std::vector<double>& f_before) const {
    const auto free = y;
    (void)system_->clamp_states(y.data());
    for (std::size_t i = 0; i < states_; ++i)
      if (y[i] != free[i]) f_before[i] = 0.0;
  }
  /// All states, with those of the exciters at t + h.
  std::vector<double> advanced_exciters(double t) {
    auto fine = y_, f = f_;
    for (int k = 0; k < exciter_steps_; ++k) {
      if (k > 0) system_->derivatives(t, fine.data(), f.data());
      for (const Exciter& e : exciters_)
        for (std::size_t i = e.first; i < e.end; ++i)
          fine[i] += h_ / exciter_steps_ * (1.5 * f[i] - 0.5 * fine_f_before_[i]);
      fine_f_before_ = f;
      clamp(fine, fine_f_before_);
    }
    return fine;
  }

  double h_;
  int exciter_steps_;
  reference::ReferencePlants plants_;
  std::vector<network::Segment> parts_;
  reference::ReferenceSystem before_, after_;
  PsseNetwork network_before_, network_after_;
  const reference::ReferenceSystem* system_;
  const PsseNetwork* network_;
  std::size_t states_;
  std::vector<double> y_, last_;  ///< states and voltages at t and at t - h
  std::vector<double> f_, f_before_, fine_f_before_;
  std::vector<Exciter> exciters_;
  std::vector<Governor> late_governors_;
};

/// Calls see(time, signals, states) of plant `plant` every h seconds until `end` [s], twice at the switching
/// time. There must be only one switching time (of the event or of a plant's effects), a multiple of h. An
/// optional fourth argument of `see` is the real and imaginary voltage of every bus [pu]. `exciter_steps`:
/// substeps of the exciters within h; `tolerance`: of the network [pu].
template <class See>
void step_as_psse(const grid::Grid& grid, const network::Event& event, std::size_t plant, double h,
                  double end, const See& see, int exciter_steps = 1, double tolerance = kToTheEnd) {
  PsseStepper stepper(grid, event, h, end, exciter_steps, tolerance);
  const auto show = [&](double t) {
    const auto s = stepper.printed(plant, t);
    if constexpr (requires { see(t, s, stepper.states(plant), stepper.voltages()); })
      see(t, s, stepper.states(plant), stepper.voltages());
    else
      see(t, s, stepper.states(plant));
  };
  const auto steps = std::lround(end / h);
  for (long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * h;
    const bool switches = k == stepper.switching();
    stepper.derive(switches ? t * (1.0 - 1e-12) : t);  // a set-point has its new value from t on
    show(t);
    if (switches) {
      stepper.switch_over(t);
      show(t);
    }
    stepper.advance(t);
  }
}

}  // namespace swingbank::sim::test
