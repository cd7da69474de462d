#include "validate/law_timed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace swingbank::validate {
namespace {

constexpr double kRise = 0.05;  ///< of every beginning and end [s]: a jump would have no slope to follow
constexpr double kTurn = 2 * std::numbers::pi;

double edge(double tau) { return std::clamp(tau / kRise, 0.0, 1.0); }
double sawtooth(double turns) { return 2 * (turns - std::floor(turns)) - 1; }
double square(double turns) { return turns - std::floor(turns) < 0.5 ? 1 : -1; }
/// The same as Fourier series, for law files have no jumps: factor / k sin(2 k turn), turn = pi times turns.
std::string series(double factor, int step, int most) {
  std::string text;
  for (int k = 1; k <= most; k += step)
    text += fmt::format("{}{:.6g} * sin({} * turn)", k == 1 ? "" : " + ", factor / k, 2 * k);
  return text;
}

/// A shape over the time since its beginning; `b` is its second number.
struct Shape {
  std::string family;
  std::function<double(double tau, double b)> course, other = {};  ///< other: the cosine beside the sine
  std::vector<double> grid;                                        ///< of b; empty: it has none
  LawParameter second;
  std::string value, signals, words;
};

std::vector<double> frequencies(double length) {
  std::vector<double> all;
  for (double f = 0.08; f <= 3.0; f += std::max(0.02, 0.25 / length)) all.push_back(f);
  return all;
}

std::vector<Shape> shapes(double length) {
  const LawParameter none{};
  const auto time = [](const std::string& name, const std::string& meaning) {
    return LawParameter{name, "s", 0, 1e-3, 1000, false, meaning};
  };
  const LawParameter f{"f", "Hz", 0, 0.01, 30, false, "frequency"};
  const std::string rise = fmt::format("clamp(tau / {:g}, 0, 1)", kRise);
  const std::vector<double> lengths = {0.2, 0.3, 0.5, 0.75, 1, 1.5, 2, 3, 4, 6, 8, 10};
  std::vector<Shape> all;
  all.push_back({"step",
                 [](double tau, double) { return edge(tau); },
                 {},
                 {},
                 none,
                 rise,
                 "",
                 "a step of {A} that begins {begin}"});
  all.push_back({"pulse",
                 [](double tau, double b) { return edge(tau) - edge(tau - b); },
                 {},
                 lengths,
                 time("length", "how long it lasts"),
                 fmt::format("({} - clamp((tau - length) / {:g}, 0, 1))", rise, kRise),
                 "",
                 "a pulse of {A} that begins {begin} and lasts {length}"});
  all.push_back({"ramp",
                 [](double tau, double b) { return std::clamp(tau / b, 0.0, 1.0); },
                 {},
                 lengths,
                 time("length", "how long it rises"),
                 "clamp(tau / length, 0, 1)",
                 "",
                 "a ramp to {A} that begins {begin} and takes {length}"});
  all.push_back({"decaying",
                 [](double tau, double b) { return edge(tau) * std::exp(-std::max(0.0, tau) / b); },
                 {},
                 lengths,
                 time("T", "time constant of the decay"),
                 rise + " * exp(-max(tau, 0) / T)",
                 "",
                 "{A}, decaying with {T}, that begins {begin}"});
  all.push_back({"periodic", [](double tau, double b) { return edge(tau) * std::sin(kTurn * b * tau); },
                 [](double tau, double b) { return edge(tau) * std::cos(kTurn * b * tau); },
                 frequencies(length), f, rise + " * sin(2 * pi * f * tau + phase)", "",
                 "an oscillation of amplitude {A} at {f} that begins {begin} with phase {phase}"});
  all.push_back({"periodic, sawtooth",
                 [](double tau, double b) { return edge(tau) * sawtooth(b * tau); },
                 {},
                 frequencies(length),
                 f,
                 rise + " * wave",
                 "turn = \"pi * f * tau\"\nwave = \"" + series(-2 / std::numbers::pi, 1, 8) + "\"\n",
                 "a sawtooth of amplitude {A} at {f} that begins {begin}"});
  all.push_back({"periodic, square",
                 [](double tau, double b) { return edge(tau) * square(b * tau); },
                 {},
                 frequencies(length),
                 f,
                 rise + " * wave",
                 "turn = \"pi * f * tau\"\nwave = \"" + series(4 / std::numbers::pi, 2, 7) + "\"\n",
                 "a square wave of amplitude {A} at {f} that begins {begin}"});
  return all;
}

/// Where time is counted from.
struct Clock {
  bool triggered = false;
  bool scaled = false;  ///< in proportion to the power or field voltage at rest
};

class Timed {
 public:
  Timed(InputKind kind, const LawRegression& regression, double level)
      : kind_(kind), regression_(regression), level_(level) {
    for (const auto& e : regression.traces()) {
      first_ = std::min(first_, e.begin);
      last_ = std::max(last_, e.knots.back());
    }
  }

  std::vector<LawCandidate> run() const {
    std::vector<LawCandidate> all;
    for (const Shape& shape : shapes(last_ - first_))
      for (const bool triggered : {false, true}) {
        if (triggered && level_ <= 0) continue;
        for (const bool scaled : {false, true}) {
          const bool periodic = shape.second.name == "f";
          if (scaled && periodic) continue;
          if (auto law = best_of(shape, {triggered, scaled}); !law.value.empty())
            all.push_back(std::move(law));
        }
      }
    return all;
  }

 private:
  struct At {
    double begin, b;
    LawRegression::Answer answer = {};
  };
  [[nodiscard]] LawRegression::Answer answer_of(const Shape& shape, const Clock& clock, double begin,
                                                double b) const {
    const auto column = [&](const auto& course) {
      return regression_.at_knots_of([&](const LawTrace& e, double t) {
        const double tau = t - begin - (clock.triggered ? e.trigger : 0.0);
        if (!(tau > 0)) return 0.0;  // an event without a trigger has no such time
        return (clock.scaled ? e.rest : 1.0) * course(tau, b);
      });
    };
    std::vector<Eigen::VectorXd> columns = {column(shape.course)};
    if (shape.other) columns.push_back(column(shape.other));
    return regression_.fit(columns, shape.grid.empty() ? 1 : 2);
  }
  [[nodiscard]] LawCandidate best_of(const Shape& shape, const Clock& clock) const {
    const double from = clock.triggered ? 0.0 : first_, to = clock.triggered ? last_ - first_ : last_;
    const bool periodic = shape.second.name == "f";
    const double step = periodic ? 0.5 : 0.1;
    At best{from, 0};
    const std::vector<double> only = {0.0};
    const auto& grid = shape.grid.empty() ? only : shape.grid;
    for (double begin = from; begin < to - 0.3; begin += step)
      for (const double b : grid) consider(shape, clock, begin, b, best);
    refine(shape, clock, step, from, best);
    if (best.answer.factors.size() == 0 || best.answer.factors[0] == 0) return {};
    return candidate(shape, clock, best);
  }
  void consider(const Shape& shape, const Clock& clock, double begin, double b, At& best) const {
    auto answer = answer_of(shape, clock, begin, b);
    if (best.answer.factors.size() > 0 && answer.score >= best.answer.score) return;
    best = {begin, b, std::move(answer)};
  }
  /// Pattern search from the best point of the grid.
  void refine(const Shape& shape, const Clock& clock, double step, double least, At& best) const {
    const bool periodic = shape.second.name == "f";
    double by = periodic ? 0.25 / (last_ - first_) : 0.25 * best.b;
    for (int round = 0; round < 5; ++round, step /= 2, by /= 2) {
      const At centre = best;
      for (const double d : {-step / 2, 0.0, step / 2})
        for (const double c : {-by, 0.0, by}) {
          if ((d == 0 && c == 0) || centre.begin + d < least || (c != 0 && centre.b + c <= 0)) continue;
          if (shape.grid.empty() && c != 0) continue;
          consider(shape, clock, centre.begin + d, centre.b + c, best);
        }
    }
  }
  [[nodiscard]] LawCandidate candidate(const Shape& shape, const Clock& clock, const At& at) const {
    LawCandidate law;
    law.kind = kind_;
    law.family = shape.family;
    law.signal = clock.triggered ? "time since the voltage moved" : "time";
    const double a = at.answer.factors[0];
    const double amplitude = shape.other ? at.answer.factors.norm() : a;
    law.parameters.push_back({"A", clock.scaled ? "-" : "pu", amplitude, -20, 20, true,
                              clock.scaled ? "size, as a part of what it has at rest" : "size"});
    const std::string begin = clock.triggered ? "delay" : "start";
    // on a logarithmic scale a delay of nothing would have no room to grow
    law.parameters.push_back({begin, "s", std::max(clock.triggered ? 0.02 : 1e-3, at.begin), 0, 1e5, false,
                              clock.triggered ? "time from the voltage's move to its beginning"
                                              : "time of the record at which it begins"});
    if (!shape.grid.empty()) {
      law.parameters.push_back(shape.second);
      law.parameters.back().value = at.b;
    }
    if (shape.other) {
      double phase = std::atan2(at.answer.factors[1], a);
      if (phase < 0.3) phase += kTurn;
      law.parameters.push_back({"phase", "rad", phase, 0, 20, false, "phase when it begins"});
    }
    const std::string rest = kind_ == InputKind::torque ? "P0" : "Efd0";
    law.value = fmt::format("A * {}{}", clock.scaled ? rest + " * " : "", shape.value);
    law.body = fmt::format("[signals]\ntau = \"{} - {}\"\n{}", clock.triggered ? "since" : "t", begin,
                           shape.signals);
    if (clock.triggered) law.body += trigger();
    law.words = shape.words;
    replace(law.words, "{begin}",
            clock.triggered ? fmt::format("{{delay}} after the voltage has left ± {:.3g} pu", level_)
                            : "at {start} of the record");
    if (clock.scaled)
      replace(law.words, "{A}",
              kind_ == InputKind::torque ? "{A} × the active power before the event"
                                         : "{A} × the field voltage before the event");
    law.explained = at.answer.explained;
    law.score = at.answer.score;
    law.course = regression_.by_event(at.answer.course);
    return law;
  }
  [[nodiscard]] std::string trigger() const {
    return fmt::format(
        "\n[states.moved]\nunit = \"-\"\nmeaning = \"1 once the voltage has left its band\"\n"
        "derivative = \"100 * clamp(abs(V - V0) / {0:.4g} - 1, 0, 1) * (1 - moved)\"\n"
        "\n[states.since]\nunit = \"s\"\nmeaning = \"time since then\"\nderivative = \"moved\"\n",
        level_);
  }
  static void replace(std::string& text, const std::string& what, const std::string& with) {
    if (const auto at = text.find(what); at != std::string::npos) text.replace(at, what.size(), with);
  }

  InputKind kind_;
  const LawRegression& regression_;
  double level_;
  double first_ = 1e300, last_ = -1e300;
};

}  // namespace

std::vector<LawCandidate> timed_candidates(InputKind kind, const LawRegression& regression, double level) {
  return Timed(kind, regression, level).run();
}

}  // namespace swingbank::validate
