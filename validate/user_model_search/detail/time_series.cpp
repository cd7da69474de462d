#include "validate/user_model_search/detail/time_series.hpp"

namespace swingbank::validate::user_model_search {
namespace {

class Runner {
 public:
  Runner(const sim::Effect& effect, const std::vector<double>& p, fit::InputKind kind,
         const UserModelTrace& trace)
      : effect_(effect),
        kind_(kind),
        trace_(trace),
        c_(static_cast<std::size_t>(effect.coefficients), 0.0),
        x_(effect.states.size(), 0.0) {
    effect.get<double>().prepare(p.data(), {}, c_.data());
    sim::Signals<double> rest = signals(0, 0);
    rest.speed = rest.Q = rest.Ifd = 0;
    rest.V = kRated;
    rest.P = kind == fit::InputKind::torque ? trace.rest : 0.0;
    rest.t = -1;
    effect.get<double>().control.steady(effect.user_model.get(), p.data(), c_.data(), rest, x_.data());
  }
  std::vector<double> run() {
    std::vector<double> time_series;
    for (std::size_t k = 0; k < trace_.t.size(); ++k) {
      if (k > 0) step(k - 1);
      time_series.push_back(output(signals(k, 0), x_, nullptr));
    }
    return time_series;
  }

 private:
  static constexpr double kRated = 1.0;  ///< models use the deviation of V only

  /// Returns the signals between sample k and the next one, interpolated at `share`.
  [[nodiscard]] sim::Signals<double> signals(std::size_t k, double share) const {
    const auto at = [&](const std::vector<double>& v) {
      return k + 1 < v.size() ? (1 - share) * v[k] + share * v[k + 1] : v[k];
    };
    sim::Signals<double> s;
    s.t = at(trace_.t);
    s.speed = at(trace_.signal[0]);
    s.V = kRated + at(trace_.signal[1]);
    s.P = (kind_ == fit::InputKind::torque ? trace_.rest : 0.0) + at(trace_.signal[2]);
    s.Q = at(trace_.signal[3]);
    s.Ifd = at(trace_.signal[4]);
    s.Efd = kind_ == fit::InputKind::field ? trace_.rest : 0.0;
    return s;
  }
  double output(sim::Signals<double> s, const std::vector<double>& x, double* dx) const {
    std::vector<double> unused(x.size());
    double sim::Signals<double>::*out =
        kind_ == fit::InputKind::torque ? &sim::Signals<double>::Tm : &sim::Signals<double>::Efd;
    const double before = s.*out;
    effect_.get<double>().control.evaluate(effect_.user_model.get(), c_.data(), x.data(), s,
                                           dx ? dx : unused.data());
    return s.*out - before;
  }
  void step(std::size_t k) {
    if (x_.empty()) return;
    const double h = trace_.t[k + 1] - trace_.t[k];
    std::vector<double> sum(x_.size(), 0.0), derivative(x_.size(), 0.0), at = x_;
    constexpr double shares[] = {0, 0.5, 0.5, 1}, weights[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    for (int stage = 0; stage < 4; ++stage) {
      for (std::size_t i = 0; i < x_.size(); ++i) at[i] = x_[i] + shares[stage] * h * derivative[i];
      output(signals(k, shares[stage]), at, derivative.data());
      for (std::size_t i = 0; i < x_.size(); ++i) sum[i] += weights[stage] * derivative[i];
    }
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += h * sum[i];
  }

  const sim::Effect& effect_;
  fit::InputKind kind_;
  const UserModelTrace& trace_;
  std::vector<double> c_, x_;
};

}  // namespace

TimeSeries user_model_time_series(const sim::Effect& effect, const std::vector<double>& parameters,
                                  fit::InputKind kind, const std::vector<UserModelTrace>& traces) {
  TimeSeries all;
  for (const UserModelTrace& trace : traces) all.push_back(Runner(effect, parameters, kind, trace).run());
  return all;
}

}  // namespace swingbank::validate::user_model_search
