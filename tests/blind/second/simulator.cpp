#include "tests/blind/second/simulator.hpp"

#include <algorithm>

namespace swingbank::blind_second {
namespace {

constexpr std::size_t kStates = 6 + 2 + 2 + 7 + 2;
using Vector = std::array<double, kStates>;

/// States by name, packed for the integrator.
struct State {
  Rotor rotor;
  Sexs::State exciter;
  Tgov1::State governor;
  Ieeest::State stabiliser;
  UnlistedDisturbance::Memory unlisted{};
};
Vector pack(const State& s) {
  const auto& r = s.rotor;
  const auto& p = s.stabiliser;
  return {
      r.delta,           r.w, r.Eq1, r.Ed1, r.psi1, r.psi2, s.exciter.lag, s.exciter.Efd, s.governor.valve,
      s.governor.reheat, p.a, p.da,  p.b,   p.db,   p.lag1, p.lag2,        p.wash,        s.unlisted[0],
      s.unlisted[1]};
}
State unpack(const Vector& v) {
  return {{v[0], v[1], v[2], v[3], v[4], v[5]},
          {v[6], v[7]},
          {v[8], v[9]},
          {v[10], v[11], v[12], v[13], v[14], v[15], v[16]},
          {v[17], v[18]}};
}

class Simulation {
 public:
  explicit Simulation(const Setup& setup) : s_(setup), stretch_(setup.grid) {
    const Phasor current = std::conj(Phasor(s_.P, s_.Q) / s_.V);
    const Phasor terminal = s_.V + s_.transformer * current;
    start_.rotor = at_rest(s_.machine, terminal, current, Efd_, Pm_);
    if (s_.exciter) start_.exciter = s_.exciter->rest(Efd_, std::abs(terminal));
    if (s_.governor) start_.governor = s_.governor->rest(Pm_);
    V0_ = std::abs(terminal);
  }
  [[nodiscard]] Vector start() const { return pack(start_); }
  /// Times of all steps [s], sorted.
  [[nodiscard]] std::vector<double> step_times() const {
    std::vector<double> all = s_.unlisted.step_times;
    for (const Stretch& g : stretch_) all.push_back(g.start);
    all.push_back(s_.dip.start);
    std::ranges::sort(all);
    return all;
  }
  /// Derivatives at t, with the inputs of the segment that contains the time `within`.
  Vector rates(double t, double within, const Vector& v) {
    const State x = unpack(v);
    solve(t, within, x);
    State r;
    r.rotor = blind_second::rates(s_.machine, x.rotor, current_, Efd_now_, Pm_now_, s_.hz, torques_);
    if (s_.exciter) r.exciter = s_.exciter->rates(x.exciter, std::abs(terminal_), Vs_);
    if (s_.governor) r.governor = s_.governor->rates(x.governor, x.rotor.w);
    if (s_.stabiliser) r.stabiliser = s_.stabiliser->rates(x.stabiliser, x.rotor.w);
    if (s_.unlisted.rates) r.unlisted = s_.unlisted.rates(std::abs(terminal_) - V0_, x.unlisted);
    return pack(r);
  }
  void clamp(Vector& v) const {
    if (s_.exciter) v[7] = std::clamp(v[7], s_.exciter->low, s_.exciter->high);
    if (s_.governor) v[8] = std::clamp(v[8], s_.governor->low, s_.governor->high);
  }
  void record(double t, double within, const Vector& v, Output& out) {
    (void)rates(t, within, v);
    const Phasor measured = current_ * s_.ct_error, power = bus_ * std::conj(measured);
    double angle = std::arg(bus_);
    if (!out.theta.empty()) angle += 2 * kPi * std::round((out.theta.back() - angle) / (2 * kPi));
    out.t.push_back(t);
    out.V.push_back(std::abs(bus_));
    out.theta.push_back(angle);
    out.P.push_back(power.real());
    out.Q.push_back(power.imag());
    out.w.push_back(v[1]);
    out.Ifd.push_back(torques_.Ifd);
    out.Efd.push_back(Efd_now_);
    out.Pm.push_back(Pm_now_);
  }

 private:
  /// Computes currents, voltages and controller outputs.
  void solve(double t, double within, const State& x) {
    const Stretch* now = &stretch_.front();
    for (const Stretch& g : stretch_)
      if (g.start <= within) now = &g;
    Phasor source = now->source;
    if (t > s_.dip.start) {  // angle: the integral of the frequency
      const double since = t - s_.dip.start, lag = s_.dip.tau * (1 - std::exp(-since / s_.dip.tau));
      source *= std::exp(kJ * 2.0 * kPi * s_.hz * s_.dip.depth * (since - lag));
    }
    const Phasor inner = internal_voltage(s_.machine, x.rotor);
    const Phasor own(s_.machine.Ra, s_.machine.X2);
    current_ = (inner - source) / (own + s_.transformer + now->impedance);
    terminal_ = inner - own * current_;
    bus_ = terminal_ - s_.transformer * current_;
    Vs_ = s_.stabiliser ? s_.stabiliser->output(x.stabiliser) : 0.0;
    Efd_now_ = s_.exciter ? s_.exciter->output(x.exciter) : Efd_;
    Pm_now_ = s_.governor ? s_.governor->output(x.governor, x.rotor.w) : Pm_;
    if (s_.unlisted.torque) Pm_now_ += s_.unlisted.torque(t, within, x.rotor.w, x.unlisted);
    if (s_.unlisted.field) Efd_now_ = s_.unlisted.field(within, Efd_now_, x.unlisted);
  }

  Setup s_;
  std::vector<Stretch> stretch_;
  State start_;
  double Efd_ = 0, Pm_ = 0, V0_ = 1;
  Phasor current_, terminal_, bus_;
  double Vs_ = 0, Efd_now_ = 0, Pm_now_ = 0;
  Torques torques_{};
};

Vector moved(const Vector& x, double h, const Vector& k) {
  Vector y;
  for (std::size_t i = 0; i < kStates; ++i) y[i] = x[i] + h * k[i];
  return y;
}

/// One classical Runge-Kutta step from t to t + h; no input has a step inside this interval.
void advance(Simulation& s, double t, double h, Vector& x) {
  const double middle = t + h / 2;
  const Vector k1 = s.rates(t, middle, x), k2 = s.rates(middle, middle, moved(x, h / 2, k1));
  const Vector k3 = s.rates(middle, middle, moved(x, h / 2, k2)),
               k4 = s.rates(t + h, middle, moved(x, h, k3));
  for (std::size_t i = 0; i < kStates; ++i) x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
  s.clamp(x);
}

}  // namespace

Phasor source_voltage(const Setup& setup, Phasor impedance) {
  return setup.V - impedance * std::conj(Phasor(setup.P, setup.Q) / setup.V);
}

Output simulate(const Setup& setup, double seconds, double rate, double step) {
  Simulation s(setup);
  Vector x = s.start();
  const std::vector<double> step_times = s.step_times();
  const auto per_sample = static_cast<long>(std::lround(1.0 / (rate * step)));
  const auto steps = static_cast<long>(std::lround(seconds / step));
  Output out;
  s.record(0.0, -1.0, x, out);
  for (long k = 0; k < steps; ++k) {
    const double end = static_cast<double>(k + 1) * step;
    double t = static_cast<double>(k) * step, last = t;
    for (auto step_time = std::ranges::upper_bound(step_times, t);
         step_time != step_times.end() && *step_time < end; ++step_time) {
      advance(s, t, *step_time - t, x);
      t = *step_time;
    }
    last = t;
    advance(s, t, end - t, x);
    if ((k + 1) % per_sample == 0) s.record(end, (last + end) / 2, x, out);
  }
  return out;
}

}  // namespace swingbank::blind_second
