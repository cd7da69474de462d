#include "validate/user_model_search/detail/timed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "validate/user_model_search/detail/shapes.hpp"

namespace swingbank::validate::user_model_search {
namespace {

using Kind = UserModelShape::Kind;

/// Time origin and output scale of a candidate.
struct Clock {
  bool triggered = false;  ///< whether time counts from the voltage deviation, else from record time 0
  bool scaled = false;  ///< whether the output is proportional to the initial active power or field voltage
};

void replace(std::string& text, const std::string& what, const std::string& with) {
  if (const auto at = text.find(what); at != std::string::npos) text.replace(at, what.size(), with);
}

class Timed {
 public:
  Timed(fit::InputKind kind, const UserModelRegression& regression, double level)
      : kind_(kind), regression_(regression), level_(level) {
    for (const auto& e : regression.traces()) {
      first_ = std::min(first_, e.begin);
      last_ = std::max(last_, e.knots.back());
    }
  }

  std::vector<UserModelCandidate> run() const {
    std::vector<UserModelCandidate> all;
    for (const UserModelShape& shape : user_model_shapes(last_ - first_))
      for (const bool triggered : {true, false})
        for (const bool scaled : {false, true}) {
          if ((triggered && level_ <= 0) || (scaled && shape.kind != Kind::once)) continue;
          if (auto user_model = best_of(shape, {triggered, scaled}); !user_model.value.empty())
            all.push_back(std::move(user_model));
        }
    return all;
  }

 private:
  struct At {
    double begin, b;
    UserModelRegression::Result result = {};
  };
  [[nodiscard]] UserModelRegression::Result result_of(const UserModelShape& shape, const Clock& clock,
                                                      double begin, double b) const {
    const auto column = [&](const auto& time_series) {
      return regression_.at_knots_of([&](const UserModelTrace& e, double t) {
        const double tau = t - begin - (clock.triggered ? e.trigger : 0.0);
        if (!(tau > 0)) return 0.0;  // also if the event has no trigger (NaN)
        return (clock.scaled ? e.rest : 1.0) * time_series(tau);
      });
    };
    std::vector<Eigen::VectorXd> columns;
    if (shape.kind == Kind::sine) {
      columns.push_back(column(
          [&](double tau) { return shape.time_series(tau, b) * std::sin(constants::turn * b * tau); }));
      columns.push_back(column(
          [&](double tau) { return shape.time_series(tau, b) * std::cos(constants::turn * b * tau); }));
    } else {
      columns.push_back(column([&](double tau) { return shape.time_series(tau, b); }));
    }
    return regression_.fit(columns, shape.grid.empty() ? 1 : 2);
  }

  [[nodiscard]] UserModelCandidate best_of(const UserModelShape& shape, const Clock& clock) const {
    const double from = clock.triggered ? 0.0 : first_, to = clock.triggered ? last_ - first_ : last_;
    // A wave may have started up to one period before the inferred input.
    const auto least = [&](double b) {
      return shape.kind == Kind::wave && !clock.triggered ? from - 1 / b : from;
    };
    double step = shape.kind == Kind::once ? 0.1 : 0.5;
    At best{from, 0};
    const std::vector<double> only = {0.0};
    for (const double b : shape.grid.empty() ? only : shape.grid)
      for (double begin = least(b); begin < to - 0.3; begin += step) consider(shape, clock, begin, b, best);
    // Pattern search from the best grid point.
    double by = shape.kind == Kind::once ? 0.25 * best.b : 0.25 / (last_ - first_);
    for (int round = 0; round < 5; ++round, step /= 2, by /= 2) {
      const At centre = best;
      for (const double d : {-step / 2, 0.0, step / 2})
        for (const double c : {-by, 0.0, by}) {
          if ((d == 0 && c == 0) || (c != 0 && (shape.grid.empty() || centre.b + c <= 0))) continue;
          if (centre.begin + d >= least(centre.b + c))
            consider(shape, clock, centre.begin + d, centre.b + c, best);
        }
    }
    if (best.result.factors.size() == 0 || best.result.factors.isZero()) return {};
    return candidate(shape, clock, best, best.begin <= from && shape.kind == Kind::sine);
  }
  void consider(const UserModelShape& shape, const Clock& clock, double begin, double b, At& best) const {
    auto result = result_of(shape, clock, begin, b);
    if (best.result.factors.size() > 0 && result.score >= best.result.score) return;
    best = {begin, b, std::move(result)};
  }

  /// Returns the candidate. `always`: the candidate is active from the start of the inferred input, so the
  /// start time is no parameter.
  [[nodiscard]] UserModelCandidate candidate(const UserModelShape& shape, const Clock& clock, const At& at,
                                             bool always) const {
    UserModelCandidate user_model;
    user_model.kind = kind_;
    user_model.family = shape.family + (clock.scaled ? ", in proportion" : "");
    user_model.signal = clock.triggered ? "time since the voltage deviation" : "time";
    user_model.parameters.push_back(
        {"A", clock.scaled ? "-" : "pu",
         shape.kind == Kind::sine ? at.result.factors.norm() : at.result.factors[0], -20, 20, true,
         clock.scaled ? "amplitude relative to the steady-state value" : "amplitude"});
    const std::string now = clock.triggered ? "since" : "t";
    user_model.words = shape.words;
    user_model.body =
        fmt::format("[signals]\ntau = \"{} - {}\"\n", now, add_begin(clock, at, always, user_model));
    if (!shape.grid.empty()) {
      user_model.parameters.push_back(shape.second);
      user_model.parameters.back().value = at.b;
    }
    if (shape.kind == Kind::sine) add_phase(clock, at, now, user_model);
    user_model.body += shape.signals;
    const bool torque = kind_ == fit::InputKind::torque;
    user_model.value =
        fmt::format("A * {}{}", clock.scaled ? (torque ? "P0 * " : "Efd0 * ") : "", shape.value);
    if (clock.triggered) user_model.body += trigger();
    if (clock.scaled)
      replace(user_model.words, "{A}",
              fmt::format("{{A}} × the {} before the event", torque ? "active power" : "field voltage"));
    user_model.explained = at.result.explained;
    user_model.score = at.result.score;
    user_model.time_series = regression_.by_event(at.result.time_series);
    return user_model;
  }
  /// Adds the start time as a parameter and returns its name; returns a constant for `always`.
  std::string add_begin(const Clock& clock, const At& at, bool always, UserModelCandidate& user_model) const {
    const std::string level = fmt::format("the voltage leaves a band of ± {:.3g} pu", level_);
    if (always) {
      replace(user_model.words, "{begin}", clock.triggered ? "when " + level : "before the event");
      return fmt::format("{:.4g}", clock.triggered ? 0.0 : first_ - 0.05);
    }
    replace(user_model.words, "{begin}",
            clock.triggered ? "{delay} after " + level : std::string("at {start} of the record"));
    if (clock.triggered)  // a delay of zero could not change on a logarithmic scale
      user_model.parameters.push_back({"delay", "s", std::max(0.02, at.begin), 0, 1e5, false,
                                       "delay of the start after the voltage deviation"});
    else
      user_model.parameters.push_back({"start", "s", at.begin, -1e5, 1e5, false, "start time in the record"});
    return user_model.parameters.back().name;
  }
  /// Adds the phase at the centre of the records, where it is nearly independent of the frequency.
  void add_phase(const Clock& clock, const At& at, const std::string& now,
                 UserModelCandidate& user_model) const {
    const double middle =
        std::round((clock.triggered ? (last_ - first_) / 2 : (first_ + last_) / 2) * 10) / 10;
    double phase =
        std::atan2(at.result.factors[1], at.result.factors[0]) + constants::turn * at.b * (middle - at.begin);
    phase -= constants::turn * std::floor(phase / constants::turn);
    if (phase < 0.3) phase += constants::turn;  // leaves room for smaller values on a logarithmic scale
    user_model.parameters.push_back(
        {"phase", "rad", phase, 0, 20, false, "phase in the middle of the records"});
    user_model.body += fmt::format("turned = \"{} - {:g}\"\n", now, middle);
    replace(
        user_model.words, "{centre}",
        fmt::format("{:g} s {}", middle, clock.triggered ? "after the voltage deviation" : "of the record"));
  }
  [[nodiscard]] std::string trigger() const {
    return fmt::format(
        "\n[states.moved]\nunit = \"-\"\nmeaning = \"1 after the voltage has deviated by {0:.4g} pu\"\n"
        "derivative = \"100 * clamp(abs(V - V0) / {0:.4g} - 1, 0, 1) * (1 - moved)\"\n"
        "\n[states.since]\nunit = \"s\"\nmeaning = \"time since the voltage deviation\"\nderivative = \"moved\"\n",
        level_);
  }

  fit::InputKind kind_;
  const UserModelRegression& regression_;
  double level_;
  double first_ = 1e300, last_ = -1e300;
};

}  // namespace

std::vector<UserModelCandidate> timed_candidates(fit::InputKind kind, const UserModelRegression& regression,
                                                 double level) {
  return Timed(kind, regression, level).run();
}

}  // namespace swingbank::validate::user_model_search
