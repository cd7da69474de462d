#include "validate/playin/detail/playback_pq.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/constants.hpp"
#include "base/stop_signal.hpp"
#include "sim/plant/equations.hpp"
#include "sim/plant/tableau.hpp"
#include "validate/playin/detail/pairs.hpp"

namespace swingbank::validate::playin {
namespace {

class PowerPlayback {
 public:
  explicit PowerPlayback(const PowerPlaybackRun& run)
      : run_(run),
        equations_(*run.plant),
        scratch_(static_cast<std::size_t>(equations_.scratch())),
        to_machine_(run.record->base.mva / run.plant->mva) {
    auto at = sim::plant::operating_point_of<double>(*run.plant, sim::plant::block_parameters(*run.plant),
                                                     run.start.voltage, run.start.P * to_machine_,
                                                     run.start.Q * to_machine_, run.conventions);
    c_ = std::move(at.c);
    x_ = std::move(at.x);
    Efd_ = at.Efd;
    Tm_ = at.Tm;
    voltage_ = run.start.voltage;
    terminal_ = {at.s.Vr, at.s.Vi};
    for (auto& k : k_) k.resize(x_.size());
    trial_.resize(x_.size());
    collect_switching_times();
  }

  PowerResponse run() {
    const record::Record& r = *run_.record;
    const double slack = r.time_slack();
    t_ = r.t.front();
    for (const double sample : r.t) {
      while (next_ < times_.size() && sample > times_[next_].time + slack) {
        advance(times_[next_].time);
        segment_ += times_[next_].switches ? 1 : 0;
        ++next_;
      }
      advance(sample);
      record(sample);
    }
    response_.steps = steps_;
    return std::move(response_);
  }

 private:
  struct SwitchingTime {
    double time;
    bool switches;  ///< true: switching of the record; false: of an effect
  };
  void collect_switching_times() {
    for (const auto& s : run_.power->switchings()) times_.push_back({s.time, true});
    for (const double t : sim::plant::switching_times_of(*run_.plant))
      if (t > run_.record->t.front() && t < run_.record->t.back()) times_.push_back({t, false});
    std::ranges::stable_sort(times_, {}, &SwitchingTime::time);
  }

  /// Returns the voltage from E conj(V) = |V|^2 + Z conj(S). This is a quadratic equation in |V|^2 with two
  /// solutions, whose product is |Z S|^2. The recorded voltage selects one of them.
  [[nodiscard]] std::optional<Complex> behind_impedance(Complex e, Complex s, double recorded) const {
    const double* z = equations_.impedance(c_.data());
    const Complex b = Complex(z[0], z[1]) * std::conj(s);
    const double middle = std::norm(e) / 2 - b.real(), rest = middle * middle - std::norm(b);
    if (!(rest >= 0)) return std::nullopt;
    const double w = recorded * recorded >= std::abs(b) ? middle + std::sqrt(rest)
                                                        : std::norm(b) / (middle + std::sqrt(rest));
    return std::conj((w + b) / e);
  }
  /// Solves V conj(I) = S at the grid side for a machine whose current is a nonlinear function of its
  /// voltage. Newton's method with finite differences finds the terminal voltage, starting from the last
  /// solution.
  std::optional<Complex> by_newton(const double* x, Complex s, sim::Signals<double>& signals) {
    const auto grid_side = [&](Complex v) {
      signals.Vr = v.real();
      signals.Vi = v.imag();
      equations_.current(c_.data(), x, scratch_.data(), signals);
      return equations_.to_grid(c_.data(), signals);
    };
    const auto gap = [&](Complex v) {
      const auto [voltage, current] = grid_side(v);
      return voltage * std::conj(current) - s;
    };
    constexpr double kStep = 1e-7;
    Complex v = terminal_;
    for (int i = 0; i < 30; ++i) {
      const Complex g = gap(v), by_r = (gap(v + kStep) - g) / kStep,
                    by_i = (gap(v + Complex(0, kStep)) - g) / kStep;
      const double det = by_r.real() * by_i.imag() - by_i.real() * by_r.imag();
      const Complex move((g.real() * by_i.imag() - by_i.real() * g.imag()) / det,
                         (by_r.real() * g.imag() - g.real() * by_r.imag()) / det);
      v -= move;
      if (!std::isfinite(std::abs(v))) return std::nullopt;
      if (std::abs(move) < 1e-12) {
        terminal_ = v;
        return grid_side(v).first;
      }
    }
    return std::nullopt;
  }

  /// Computes the derivatives; returns false if no voltage delivers P + jQ.
  bool evaluate(double t, const double* x, double* dx) {
    signals_.Efd = Efd_;
    signals_.Tm = Tm_;
    signals_.dVref = signals_.dPref = 0;
    signals_.t = next_ < times_.size() ? std::min(t, times_[next_].time - sim::plant::kBeforeSwitching) : t;
    const Complex s = (*run_.power)(segment_, t) * to_machine_;
    double er, ei, ir, ii;
    equations_.emf(c_.data(), x, scratch_.data(), er, ei);
    const auto v = equations_.nonlinear()
                       ? by_newton(x, s, signals_)
                       : behind_impedance({er, ei}, s, std::abs((*run_.voltage)(segment_, t)));
    unsolved_ = !v;
    if (unsolved_) return false;
    voltage_ = *v;
    signals_.Vpr = v->real();
    signals_.Vpi = v->imag();
    equations_.from_grid(c_.data(), x, scratch_.data(), er, ei, signals_, ir, ii);
    equations_.derivative(c_.data(), x, scratch_.data(), signals_, dx);
    return true;
  }

  void advance(double to) {
    while (t_ < to) {
      interruption_point();
      const double left = to - t_;
      const bool reaches = h_ >= left * (1 - 1e-12);
      const double h = reaches ? left : h_;
      const double error = attempt(h);
      if (error <= 1) {
        t_ = reaches ? to : t_ + h;
        std::swap(x_, trial_);
        double moved = 0;
        equations_.clamp_states(c_.data(), x_.data(), moved);
      } else if (h < kShortestStep) {
        give_up();
      }
      h_ = next_step(h_, h, error, std::pow(error + 1e-12, kFineSteps.exponent), reaches);
      if (++steps_ > run_.step_limit) give_up();
    }
    t_ = std::max(t_, to);
  }
  double attempt(double h) {
    namespace dp = sim::plant::dp54;
    for (std::size_t stage = 0; stage < dp::kStages; ++stage) {
      for (std::size_t i = 0; i < x_.size(); ++i) {
        double sum = 0;
        for (std::size_t j = 0; j < stage; ++j) sum += dp::a[stage][j] * k_[j][i];
        trial_[i] = x_[i] + h * sum;
      }
      if (!evaluate(t_ + dp::c[stage] * h, trial_.data(), k_[stage].data())) return INFINITY;
    }
    double worst = 0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      double e = 0;
      for (std::size_t j = 0; j < dp::kStages; ++j) e += dp::error[j] * k_[j][i];
      const double ratio = h * std::abs(e) / (run_.tolerance * (1 + std::abs(x_[i])));
      if (!std::isfinite(ratio)) return ratio;
      worst = std::max(worst, ratio);
    }
    return worst;
  }

  void record(double t) {
    if (!evaluate(t, x_.data(), k_[0].data())) give_up();
    const double turn = constants::turn;
    const double theta = std::arg(voltage_) + run_.start.drift * t;
    const double last = response_.theta.empty() ? run_.record->theta.front() : response_.theta.back();
    response_.V.push_back(std::abs(voltage_));
    response_.theta.push_back(theta - turn * std::round((theta - last) / turn));
    response_.speed.push_back(signals_.speed + run_.start.drift / (turn * run_.conventions.frequency));
    response_.Efd.push_back(signals_.Efd);
    response_.Ifd.push_back(signals_.Ifd);
  }

  [[noreturn]] void give_up() const {
    const Complex s = (*run_.power)(segment_, t_);
    const std::string when = fmt::format("t = {:.4f} s of {}", t_, run_.record->name);
    if (unsolved_)
      throw InputError(
          {fmt::format("no terminal voltage exists for P = {:.4f}, Q = {:.4f} pu", s.real(), s.imag()), when,
           "this power exceeds the maximum that the machine's internal voltage can deliver "
           "through its impedance",
           "check base and sign of P and Q, or play in the voltage instead (--playback voltage)"});
    throw InputError(
        {"playback failed", when, "the plant's equations cannot be integrated further with this power",
         "check the parameters (time constants, limits) and the record at that time, or play in the "
         "voltage instead (--playback voltage)"});
  }

  const PowerPlaybackRun& run_;
  sim::plant::PlantEquations<double> equations_;
  std::vector<double> c_, x_, trial_, scratch_;
  std::array<std::vector<double>, sim::plant::dp54::kStages> k_;
  double Efd_ = 0, Tm_ = 0, to_machine_;
  Complex voltage_, terminal_;  ///< voltage at the grid side and at the machine [pu]
  sim::Signals<double> signals_;
  std::vector<SwitchingTime> times_;
  std::size_t next_ = 0;
  int segment_ = 0, steps_ = 0;
  bool unsolved_ = false;  ///< whether the last evaluation found no voltage
  double t_ = 0, h_ = 1e-3;
  PowerResponse response_;
};

}  // namespace

VoltageCurve power_curve(const record::Record& record, std::vector<Switching> switchings) {
  record::Record power;  // P + jQ stored as a phasor V, theta
  power.name = record.name;
  power.t = record.t;
  for (std::size_t k = 0; k < record.t.size(); ++k) {
    power.V.push_back(std::hypot(record.P[k], record.Q[k]));
    power.theta.push_back(std::atan2(record.Q[k], record.P[k]));
  }
  for (auto& s : switchings) s.has_before = s.has_after = false;  // known for the voltage only
  return {power, std::move(switchings)};
}

PowerResponse simulate_power_playback(const PowerPlaybackRun& run) { return PowerPlayback(run).run(); }

}  // namespace swingbank::validate::playin
