// Candidates that depend on a signal: unfiltered, lagged or washed out; linear, limited, dead-banded or
// curved.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "validate/user_model_search/detail/timed.hpp"
#include "validate/user_model_search/regression.hpp"

namespace swingbank::validate::user_model_search {
namespace {

enum class Filter { none, lag, washout };
enum class Shape { straight, limited, dead_band, signed_square, even, curve };

struct Form {
  std::size_t signal = 0;
  Filter filter = Filter::none;
  double T = 0;  ///< time constant of the filter [s]
  Shape shape = Shape::straight;
  /// Deviation at the limit, or half-width of the dead band; of a curve: its last point [pu].
  double width = 0;
  double ratio = 0;  ///< of a curve: ratio of each point to the next one, below 1
};
constexpr int kPoints = 4;  ///< number of points of a curve on either side of zero

/// Returns the abscissa of a curve's point, k = 0 ... kPoints.
double point_of(const Form& f, int k) { return k == 0 ? 0.0 : f.width * std::pow(f.ratio, kPoints - k); }

/// Returns the response of a first-order lag to a time series that starts at zero.
std::vector<double> lagged(const std::vector<double>& t, const std::vector<double>& x, double T) {
  std::vector<double> y(x.size(), 0.0);
  for (std::size_t k = 1; k < x.size(); ++k) {
    const double share = -std::expm1(-(t[k] - t[k - 1]) / T);
    y[k] = y[k - 1] + share * ((x[k] + x[k - 1]) / 2 - y[k - 1]);
  }
  return y;
}
TimeSeries filtered(const std::vector<UserModelTrace>& traces, const Form& f) {
  TimeSeries all;
  for (const auto& e : traces) {
    const auto& x = e.signal[f.signal];
    if (f.filter == Filter::none) {
      all.push_back(x);
      continue;
    }
    auto y = lagged(e.t, x, f.T);
    if (f.filter == Filter::washout)
      for (std::size_t k = 0; k < y.size(); ++k) y[k] = x[k] - y[k];
    all.push_back(std::move(y));
  }
  return all;
}
TimeSeries shaped(TimeSeries time_series, const Form& f) {
  for (auto& event : time_series)
    for (double& x : event) switch (f.shape) {
        case Shape::straight:
        case Shape::curve:
          break;
        case Shape::limited:
          x = std::clamp(x / f.width, -1.0, 1.0);
          break;
        case Shape::dead_band:
          x = std::max(0.0, x - f.width) - std::max(0.0, -x - f.width);
          break;
        case Shape::signed_square:
          x *= std::abs(x);
          break;
        case Shape::even:
          x *= x;
          break;
      }
  return time_series;
}
/// Returns hat functions of the signal at a curve's points, odd in the signal. Beyond the last point the
/// value is constant.
std::vector<TimeSeries> hats(const TimeSeries& time_series, const Form& f) {
  std::vector<TimeSeries> all(kPoints, time_series);
  for (int k = 1; k <= kPoints; ++k) {
    const double low = point_of(f, k - 1), mid = point_of(f, k), high = k < kPoints ? point_of(f, k + 1) : 0;
    for (auto& event : all[static_cast<std::size_t>(k - 1)])
      for (double& x : event) {
        const double size = std::abs(x);
        double y = std::clamp((size - low) / (mid - low), 0.0, 1.0);
        if (k < kPoints) y -= std::clamp((size - mid) / (high - mid), 0.0, 1.0);
        x = std::copysign(y, x);
      }
  }
  return all;
}
double largest(const TimeSeries& time_series) {
  double most = 0;
  for (const auto& e : time_series)
    for (const double x : e) most = std::max(most, std::abs(x));
  return most;
}

UserModelParameter gain_of(const std::string& name, double value, double most, const std::string& meaning) {
  return {name, "pu", value, -most, most, true, meaning};
}

/// Describes an odd piecewise linear curve through the points (w1, u1), (w2, u2), ...
void describe_curve(const Form& f, const Eigen::VectorXd& factors, UserModelCandidate& user_model) {
  const double least = 0.05 * factors.cwiseAbs().maxCoeff();
  std::string points, order;
  for (int k = 1; k <= kPoints; ++k) {
    double u = factors[k - 1];
    if (std::abs(u) < least)
      u = std::copysign(least, u);  // the fit changes values by factors, so a value of zero would stay zero
    user_model.parameters.push_back({fmt::format("w{}", k), "pu", point_of(f, k), 1e-7, 10.0, false,
                                     fmt::format("deviation at point {}", k)});
    user_model.parameters.push_back(
        {fmt::format("u{}", k), "pu", u, -10.0, 10.0, false, fmt::format("value at point {}", k)});
    points += fmt::format("{}{{u{}}} at {{w{}}}", k == 1 ? "" : ", ", k, k);
    if (k == 1) {
      user_model.value = "u1 * clamp(x / w1, -1, 1)";
      continue;
    }
    user_model.value += fmt::format(
        " + (u{0} - u{1}) * (clamp(x, -w{0}, w{0}) - clamp(x, -w{1}, w{1})) / (w{0} - w{1})", k, k - 1);
    order += fmt::format("{}\"w{} < w{}\"", k == 2 ? "" : ", ", k - 1, k);
  }
  user_model.requirements = order;
  user_model.words = "an odd function of {x} through " + points + ", linear in between";
}
/// Writes the TOML expression and the description of each shape.
void describe_shape(const Form& f, const Eigen::VectorXd& factors, UserModelCandidate& user_model) {
  constexpr double kMostGain = 1e6, kMostLevel = 10;
  const double factor = factors[0];
  const std::string y = f.filter == Filter::none ? "x" : "filtered";
  const UserModelParameter limit{"w", "pu", f.width, 1e-7, 10.0, false, "deviation at the limit"};
  const UserModelParameter band{"w", "pu", f.width, 1e-7, 10.0, false, "dead band"};
  switch (f.shape) {
    case Shape::straight:
      user_model.value = "K * " + y;
      user_model.words = "{K} × {x}";
      user_model.parameters = {gain_of("K", factor, kMostGain, "gain")};
      break;
    case Shape::limited:
      user_model.value = "L * clamp(" + y + " / w, -1, 1)";
      user_model.words = "{L} with the sign of {x} beyond ± {w}, proportional within";
      user_model.parameters = {gain_of("L", factor, kMostLevel, "limit"), limit};
      break;
    case Shape::dead_band:
      user_model.value = "K * deadband(" + y + ", w)";
      user_model.words = "{K} × {x} outside a dead band of ± {w}";
      user_model.parameters = {gain_of("K", factor, kMostGain, "gain outside the dead band"), band};
      break;
    case Shape::signed_square:
      user_model.value = "K * " + y + " * abs(" + y + ")";
      user_model.words = "{K} × the square (with its sign) of {x}";
      user_model.parameters = {gain_of("K", factor, kMostGain, "gain")};
      break;
    case Shape::even:
      user_model.value = "K * " + y + "^2";
      user_model.words = "{K} × the square of {x}";
      user_model.parameters = {gain_of("K", factor, kMostGain, "gain")};
      break;
    case Shape::curve:
      describe_curve(f, factors, user_model);
      break;
  }
}
UserModelCandidate candidate_of(fit::InputKind kind, const Form& f, const Eigen::VectorXd& factors) {
  const UserModelSignal& s = kUserModelSignals[f.signal];
  UserModelCandidate user_model;
  user_model.kind = kind;
  user_model.signal = s.name;
  describe_shape(f, factors, user_model);
  std::string x(s.words);
  if (f.filter != Filter::none)
    x += f.filter == Filter::lag ? " (lagged by {T})" : " (washed out within {T})";
  user_model.words.replace(user_model.words.find("{x}"), 3, x);
  user_model.body = fmt::format("[signals]\nx = \"{}\"\n", s.expression);
  constexpr std::array kShapes = {"static", "limited", "dead-banded", "quadratic", "even", "curved"};
  user_model.family = kShapes[static_cast<std::size_t>(f.shape)];
  if (f.filter == Filter::none) return user_model;
  const bool lag = f.filter == Filter::lag;
  user_model.family =
      (f.shape == Shape::straight ? "" : user_model.family + ", ") + (lag ? "lagged" : "washed out");
  user_model.body +=
      fmt::format("\n[blocks.filtered]\nkind = \"{}\"\ninput = \"x\"\nT = \"T\"\n", lag ? "lag" : "washout");
  user_model.parameters.push_back({"T", "s", f.T, 1e-3, 1000.0, false, lag ? "lag" : "washout"});
  return user_model;
}

std::vector<Form> forms_of(std::size_t signal) {
  std::vector<Form> forms = {{.signal = signal}};
  for (const double T : {0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0})
    for (const Filter filter : {Filter::lag, Filter::washout})
      forms.push_back({.signal = signal, .filter = filter, .T = T});
  return forms;
}

/// Returns the traces without signals and with about 20 samples per second, which resolves the knots.
std::vector<UserModelTrace> thinned(std::vector<UserModelTrace> traces) {
  for (auto& e : traces) {
    std::vector<double> t;
    for (const double at : e.t)
      if (t.empty() || at >= t.back() + 0.049 || at == e.t.back()) t.push_back(at);
    e.t = std::move(t);
    e.signal = {};
  }
  return traces;
}

}  // namespace

double trigger_level(const noise::WhitenedEvents& events) {
  constexpr double kLeastTrigger = 0.01;  // [pu]; above instrument errors and ambient changes
  double smallest = 1e300, noise = 0;
  for (const event::FitEvent& e : events) {
    const double rest = std::abs(e.start.voltage);
    double most = 0;
    const record::Record& r = e.played();
    for (std::size_t k = 0; k < r.t.size(); ++k) {
      const double move = std::abs(r.V[k] - rest);
      (static_cast<int>(k) < e.start.samples ? noise : most) =
          std::max(static_cast<int>(k) < e.start.samples ? noise : most, move);
    }
    if (!e.switchings.empty()) smallest = std::min(smallest, most);
  }
  if (smallest > 1e299 || smallest / 2 < std::max(kLeastTrigger, 3 * noise)) return 0;
  return std::max({kLeastTrigger, 3 * noise, std::min(0.1, smallest / 2)});
}

std::vector<UserModelCandidate> user_model_candidates(fit::InputKind kind,
                                                      const std::vector<UserModelTrace>& traces,
                                                      double level) {
  const UserModelRegression regression(traces);
  struct Best {
    Form form;
    UserModelRegression::Result result;
  };
  std::map<std::tuple<std::size_t, Filter, Shape>, Best> best;
  for (std::size_t s = 0; s < kUserModelSignals.size(); ++s)
    for (Form form : forms_of(s)) {
      const TimeSeries base = filtered(traces, form);
      const double most = largest(base);
      if (!(most > 1e-9)) continue;
      const auto keep = [&](UserModelRegression::Result result) {
        Best& b = best[{s, form.filter, form.shape}];
        if (b.result.time_series.size() == 0 || result.score < b.result.score) b = {form, std::move(result)};
      };
      const int filter = form.filter == Filter::none ? 0 : 1;
      const auto consider = [&](Shape shape, double part) {
        form.shape = shape;
        form.width = part * most;
        keep(regression.fit({regression.at_knots(shaped(base, form))}, filter + (part > 0 ? 1 : 0)));
      };
      for (const Shape shape : {Shape::straight, Shape::signed_square, Shape::even}) consider(shape, 0);
      for (const double part : {0.01, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7}) {
        consider(Shape::limited, part);
        consider(Shape::dead_band, part);
      }
      if (filter > 0) continue;
      for (const double part : {0.3, 0.6, 1.0})
        for (const double ratio : {0.15, 0.3, 0.5}) {
          form.shape = Shape::curve;
          form.width = part * most;
          form.ratio = ratio;
          std::vector<Eigen::VectorXd> columns;
          for (const TimeSeries& hat : hats(base, form)) columns.push_back(regression.at_knots(hat));
          keep(regression.fit(columns, kPoints));
        }
    }
  std::vector<UserModelCandidate> all;
  for (const auto& [key, b] : best) {
    if (b.result.factors.size() == 0 || b.result.factors.isZero(0)) continue;
    UserModelCandidate user_model = candidate_of(kind, b.form, b.result.factors);
    user_model.explained = b.result.explained;
    user_model.score = b.result.score;
    user_model.time_series = regression.by_event(b.result.time_series);
    all.push_back(std::move(user_model));
  }
  const auto coarse = thinned(traces);
  for (auto& user_model : timed_candidates(kind, UserModelRegression(coarse), level))
    all.push_back(std::move(user_model));
  std::ranges::stable_sort(all, {}, &UserModelCandidate::score);
  return all;
}

}  // namespace swingbank::validate::user_model_search
