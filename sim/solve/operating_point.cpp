#include <fmt/format.h>

#include <cmath>

#include "sim/solve/grid.hpp"

namespace swingbank::sim {
namespace {

/// Where a block's coefficients and states begin.
struct Place {
  const Block* block;
  std::size_t c, x;
};

class Initialiser {
 public:
  Initialiser(const Plant& plant, Complex voltage, Complex power, const Conventions& conventions)
      : plant_(plant) {
    std::size_t c = 0, x = 0;
    const auto add = [&](const Block& block) {
      places_.push_back({&block, c, x});
      c += static_cast<std::size_t>(block.effect->coefficients);
      x += block.effect->states.size();
    };
    add(plant.machine);
    for (const Block& control : plant.controls) add(control);
    o_.c.assign(c, 0.0);
    o_.x.assign(x, 0.0);
    scratch_.assign(static_cast<std::size_t>(plant.machine.effect->scratch), 0.0);
    for (const Place& p : places_) ops(p).prepare(p.block->p.data(), conventions, o_.c.data() + p.c);
    terminal(voltage, power);
  }

  Operating run() {
    const Place& machine = places_.front();
    ops(machine).machine.source_impedance(machine.block->p.data(), o_.r, o_.xs);
    held(ops(machine).machine.steady(machine.block->p.data(), coefficients(machine), o_.s, states(machine)),
         machine);
    o_.Efd = o_.s.Efd;
    o_.Tm = o_.s.Tm;
    emf();
    ops(machine).machine.electrical(coefficients(machine), states(machine), scratch_.data(), o_.s);
    for (std::size_t i = 1; i < places_.size(); ++i)
      held(
          ops(places_[i])
              .control.steady(places_[i].block->p.data(), coefficients(places_[i]), o_.s, states(places_[i])),
          places_[i]);
    problems_.raise();
    verify();
    problems_.raise();
    return std::move(o_);
  }

 private:
  static const Ops<double>& ops(const Place& p) { return p.block->effect->get<double>(); }
  double* coefficients(const Place& p) { return o_.c.data() + p.c; }
  double* states(const Place& p) { return o_.x.data() + p.x; }
  [[nodiscard]] std::string where() const { return "generator " + plant_.name; }

  void terminal(Complex v, Complex s) {
    const Complex i = std::conj(s / v);
    o_.s.Vr = v.real();
    o_.s.Vi = v.imag();
    o_.s.V = std::abs(v);
    o_.s.Ir = i.real();
    o_.s.Ii = i.imag();
    o_.s.P = s.real();
    o_.s.Q = s.imag();
  }
  void held(const std::string& why, const Place& p) {
    if (!why.empty())
      problems_.add(std::string(p.block->effect->name) +
                        " cannot hold the operating point P = " + std::to_string(o_.s.P) +
                        " pu, Q = " + std::to_string(o_.s.Q) + " pu, V = " + std::to_string(o_.s.V) + " pu",
                    where(), why, "change the model's parameters or the dispatch");
  }
  /// The voltage behind the impedance must drive exactly the current the power flow asks for.
  void emf() {
    double er = 0.0, ei = 0.0;
    ops(places_.front())
        .machine.emf(coefficients(places_.front()), states(places_.front()), scratch_.data(), er, ei);
    const Complex drop = Complex(o_.r, o_.xs) * Complex(o_.s.Ir, o_.s.Ii);
    const double gap = std::abs(Complex(er, ei) - Complex(o_.s.Vr, o_.s.Vi) - drop);
    if (!(gap < kTolerance))
      problems_.add(fmt::format("internal voltage off by {:.3g} pu", gap), where(),
                    std::string(plant_.machine.effect->name) + " does not reproduce the terminal current",
                    "check its parameters");
  }
  void verify() {
    std::vector<double> dx(o_.x.size(), 0.0);
    // Efd and Tm are whatever the controls give; where a slot is empty they are held.
    for (std::size_t i = 1; i < places_.size(); ++i)
      ops(places_[i])
          .control.evaluate(coefficients(places_[i]), states(places_[i]), o_.s, dx.data() + places_[i].x);
    const Place& m = places_.front();
    ops(m).machine.derivative(coefficients(m), states(m), scratch_.data(), o_.s, dx.data());
    for (const Place& p : places_)
      for (std::size_t k = 0; k < p.block->effect->states.size(); ++k)
        if (!(std::abs(dx[p.x + k]) < kTolerance))
          problems_.add("state " + std::string(p.block->effect->states[k].name) + " of " +
                            std::string(p.block->effect->name) +
                            fmt::format(" moves at {:.3g} per second", dx[p.x + k]),
                        where(), "the operating point must be steady to 1e-9",
                        "check the model's parameters");
  }

  static constexpr double kTolerance = 1e-9;  // derivatives of order 1 cancel to rounding, 1e-14 or so
  const Plant& plant_;
  std::vector<Place> places_;
  std::vector<double> scratch_;
  Operating o_{};
  Problems problems_;
};

}  // namespace

Operating operating_point(const Plant& plant, Complex voltage, double base_mva,
                          const Conventions& conventions) {
  return Initialiser(plant, voltage, plant.generation * (base_mva / plant.mva), conventions).run();
}

}  // namespace swingbank::sim
