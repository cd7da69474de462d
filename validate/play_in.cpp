#include "validate/play_in.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/solve/plant_equations.hpp"
#include "sim/solve/tableau.hpp"

namespace swingbank::validate {
namespace {

constexpr int kFewestSteady = 5;  ///< samples that make a mean and a spread

/// Slope of theta over the first n samples [rad/s], or 0 if it is below five times its own standard error.
double angle_drift(const Record& r, int n) {
  double mean_t = 0, mean_a = 0, tt = 0, ta = 0, rest = 0;
  for (int k = 0; k < n; ++k) mean_t += r.t[k] / n, mean_a += r.theta[k] / n;
  for (int k = 0; k < n; ++k) {
    tt += (r.t[k] - mean_t) * (r.t[k] - mean_t);
    ta += (r.t[k] - mean_t) * (r.theta[k] - mean_a);
  }
  const double slope = ta / tt;
  for (int k = 0; k < n; ++k) {
    const double e = r.theta[k] - mean_a - slope * (r.t[k] - mean_t);
    rest += e * e;
  }
  const double error = std::sqrt(rest / (n - 2) / tt);
  // 1e-7 rad/s moves the angle by 1e-6 rad in 10 s: below that rounding of the file decides.
  return std::abs(slope) > std::max(5 * error, 1e-7) ? slope : 0.0;
}

/// The plant's equations with the terminal voltage given.
class DrivenPlant {
 public:
  DrivenPlant(const sim::Plant& plant, const sim::Operating& start, double drift)
      : equations_(plant),
        c_(start.c),
        Efd_(start.Efd),
        Tm_(start.Tm),
        drift_(drift),
        scratch_(static_cast<std::size_t>(equations_.scratch())) {}

  [[nodiscard]] int states() const { return equations_.states(); }

  /// Signals and derivative at states x with terminal voltage v at time t.
  sim::Signals<double> operator()(double t, Complex v, const double* x, double* dx) {
    sim::Signals<double> s;
    s.Efd = Efd_;
    s.Tm = Tm_;
    s.t = t;
    v *= std::polar(1.0, -drift_ * t);
    s.Vpr = v.real();
    s.Vpi = v.imag();
    double er, ei, ir, ii;
    equations_.emf(c_.data(), x, scratch_.data(), er, ei);
    equations_.from_grid(c_.data(), x, scratch_.data(), er, ei, s, ir, ii);
    equations_.derivative(c_.data(), x, scratch_.data(), s, dx);
    return s;
  }
  /// Power into the grid of signals just evaluated [pu on the machine's base].
  [[nodiscard]] Complex power(const sim::Signals<double>& s) const {
    double p, q;
    equations_.grid_power(c_.data(), s, p, q);
    return {p, q};
  }
  /// Takes states that have crossed a limit back to it.
  void clamp_states(double* x) const {
    double moved = 0.0;
    equations_.clamp_states(c_.data(), x, moved);
  }

 private:
  sim::PlantEquations<double> equations_;
  std::vector<double> c_;
  double Efd_, Tm_, drift_;
  std::vector<double> scratch_;
};

/// Dormand-Prince 5(4) with step control, from instant to instant; no step crosses an instant asked for, so
/// steps end on the spline's knots and at the switchings.
class Integrator {
 public:
  Integrator(DrivenPlant& plant, const VoltageCurve& curve, const PlayInOptions& options,
             std::vector<double> x)
      : plant_(plant), curve_(curve), options_(options), x_(std::move(x)), trial_(x_.size()) {
    for (auto& k : k_) k.resize(x_.size());
  }

  [[nodiscard]] const std::vector<double>& states() const { return x_; }
  [[nodiscard]] int steps() const { return steps_; }

  void advance(int segment, double from, double to) {
    double t = from;
    while (t < to) {
      const double left = to - t;
      const bool reaches = h_ >= left * (1 - 1e-12);
      const double h = reaches ? left : h_;
      const double error = attempt(segment, t, h);
      if (error <= 1) {
        t = reaches ? to : t + h;
        x_ = trial_;
        plant_.clamp_states(x_.data());
      } else if (h < 1e-9) {
        give_up(t);
      }
      const double factor =
          std::isfinite(error) ? std::clamp(0.9 * std::pow(error + 1e-12, -0.2), 0.2, 5.0) : 0.2;
      const bool cut_short =
          reaches && error <= 1;  // the step was short for the instant's sake, not the error's
      h_ = cut_short ? std::max(h_, h * factor) : h * factor;
      if (++steps_ > options_.step_limit) give_up(t);
    }
  }

 private:
  double attempt(int segment, double t, double h) {
    namespace dp = sim::dp54;
    const std::size_t n = x_.size();
    for (int stage = 0; stage < dp::kStages; ++stage) {
      for (std::size_t i = 0; i < n; ++i) {
        double sum = 0;
        for (int j = 0; j < stage; ++j) sum += dp::a[stage][j] * k_[j][i];
        trial_[i] = x_[i] + h * sum;
      }
      const double at = t + dp::c[stage] * h;
      plant_(at, curve_(segment, at), trial_.data(), k_[stage].data());
    }
    double worst = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double e = 0;
      for (int j = 0; j < dp::kStages; ++j) e += dp::error[j] * k_[j][i];
      const double ratio = std::abs(h * e) / (options_.tolerance * (1 + std::abs(x_[i])));
      if (!std::isfinite(ratio)) return ratio;
      worst = std::max(worst, ratio);
    }
    return worst;
  }

  [[noreturn]] void give_up(double t) const {
    throw InputError({"play-in stops", fmt::format("t = {:.4f} s", t),
                      "the plant's equations cannot be integrated further with this voltage",
                      "check the parameters (time constants, limits) and the record at that time"});
  }

  DrivenPlant& plant_;
  const VoltageCurve& curve_;
  const PlayInOptions& options_;
  std::vector<double> x_, trial_;
  std::array<std::vector<double>, 7> k_;
  double h_ = 1e-3;  ///< [s]
  int steps_ = 0;
};

}  // namespace

OperatingPoint pre_event_point(const Record& record, const std::vector<Switching>& switchings,
                               double pre_event) {
  const double until = switchings.empty() ? record.t.front() + pre_event : switchings.front().time;
  OperatingPoint point;
  while (point.samples < record.samples() &&
         record.t[static_cast<std::size_t>(point.samples)] <= until + 1e-4 * record.step())
    ++point.samples;
  const int n = point.samples;
  if (n < kFewestSteady)
    throw InputError({fmt::format("{} samples before the event", n), record.name,
                      fmt::format("the operating point is a mean over at least {}", kFewestSteady),
                      "give a record that starts earlier, or a longer --pre-event"});
  point.drift = angle_drift(record, n);
  for (int k = 0; k < n; ++k) {
    point.voltage +=
        std::polar(record.V[k], record.theta[k] - point.drift * record.t[k]) / static_cast<double>(n);
    point.P += record.P[k] / n;
    point.Q += record.Q[k] / n;
  }
  return point;
}

Playback play_in(const sim::Plant& plant, const sim::Conventions& conventions, const Record& record,
                 const VoltageCurve& curve, const PlayInOptions& options) {
  Playback back;
  back.start = pre_event_point(record, curve.switchings(), options.pre_event);
  sim::Plant started = plant;
  started.generation = {back.start.P, back.start.Q};
  const sim::Operating start =
      sim::operating_point(started, back.start.voltage, record.base.mva, conventions);
  DrivenPlant driven(started, start, back.start.drift);
  Integrator integrator(driven, curve, options, start.x);
  const double to_record = plant.mva / record.base.mva;
  std::vector<double> dx(start.x.size());
  int segment = 0;
  double t = record.t.front();
  const double slack = 1e-4 * record.step();  // as in VoltageCurve: a sample at a switching belongs before it
  for (const double sample : record.t) {
    if (sample > options.until) break;
    for (; segment + 1 < curve.segments() && sample > curve.end(segment) + slack; ++segment) {
      integrator.advance(segment, t, curve.end(segment));
      t = std::max(t, curve.end(segment));
    }
    integrator.advance(segment, t, sample);
    t = std::max(t, sample);
    const auto s = driven(sample, curve(segment, sample), integrator.states().data(), dx.data());
    const Complex power = driven.power(s) * to_record;
    back.P.push_back(power.real());
    back.Q.push_back(power.imag());
    back.speed.push_back(s.speed);
    back.Efd.push_back(s.Efd);
    back.Ifd.push_back(s.Ifd);
  }
  back.steps = integrator.steps();
  return back;
}

}  // namespace swingbank::validate
