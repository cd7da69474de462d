#include "validate/reduced/infer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/in_parallel.hpp"
#include "validate/fit/states.hpp"
#include "validate/playin/can_run.hpp"
#include "validate/reduced/detail/normal.hpp"

namespace swingbank::validate::reduced {
namespace {

using Kind = playin::SensitivityParameter::Kind;
using detail::Normal, detail::Point;
using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// Maximum number of intensities of the inputs' random walk that are tried besides the prior intensity.
constexpr int kIntensities = 5;
constexpr double kSameIntensity =
    0.7;  ///< difference of logarithms below which two intensities count as equal
/// Maximum factor between consecutive intensities. kNearIntensity: for residuals that are nonlinear in the
/// inputs; kAnyIntensity: for linear residuals.
constexpr double kNearIntensity = 100, kAnyIntensity = 1e12;
/// Knots are one sample apart until kCloseKnots [s] after a switching time. Then their spacing grows by the
/// factor kKnotGrowth from knot to knot, up to kFarApart [s].
constexpr double kCloseKnots = 0.25, kKnotGrowth = 1.15, kFarApart = 0.15;
constexpr double kMostKnots = 100;  ///< maximum number of widely spaced knots in a long record

/// Prior standard deviation of an input at the first switching time, and of the field voltage's step at later
/// switching times [pu]. A turbine's torque is continuous, but a rectifier's voltage may have a step.
constexpr double kFirstTorque = 1e-3, kFirstField = 10.0;

Knots knots_of(const event::FitEvent& event, const event::EventState& state) {
  const double h = event.record.step(), last = event.record.t.back();
  const double far_apart = std::max(kFarApart, (last - event.record.t.front()) / kMostKnots);
  std::vector<double> begins = state.switchings;
  if (begins.empty())
    begins.push_back(event.record.t[static_cast<std::size_t>(std::max(event.start.samples - 1, 0))]);
  Knots knots;
  for (std::size_t part = 0; part < begins.size(); ++part) {
    const bool ends = part + 1 < begins.size();
    const double from = begins[part], to = ends ? begins[part + 1] - sim::plant::kBeforeSwitching : last;
    double gap = h;
    for (double t = from; t < to - (ends ? gap : 0.5 * gap); t += gap) {
      knots.t.push_back(t);
      if (t - from >= kCloseKnots) gap = std::min(far_apart, gap * kKnotGrowth);
    }
    if (ends) knots.discontinuities.push_back(knots.t.size());
    knots.t.push_back(to);
  }
  return knots;
}

class Inferring {
 public:
  Inferring(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
            const std::vector<fit::FreeParameter>& free, Inputs inputs, int threads)
      : tested_(tested), events_(events), free_(free), inputs_(inputs), threads_(threads) {
    for (const auto& f : free) axes_.push_back(fit::make_axis(tested.plant, f));
  }

  void begin(const sim::plant::Plant& plant, const std::vector<event::EventState>& states) {
    simulated_ = plant;
    at_.z = VectorXd::Zero(static_cast<Index>(axes_.size()));
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      ids_.push_back(same_parameter(plant, tested_.plant, free_[i].id));
      if (ids_[i]) at_.z[static_cast<Index>(i)] = axes_[i].z(parameter_value(plant, *ids_[i]));
    }
    for (std::size_t e = 0; e < events_.size(); ++e) {
      event::EventState s = states.empty() ? event::EventState{} : states[e];
      if (s.switchings.empty()) s.switchings = event::prepared_state(events_[e]).switchings;
      const auto numbers = fit::state_of(events_[e], s);
      at_.states.emplace_back(Eigen::Map<const VectorXd>(numbers.data(), static_cast<Index>(numbers.size())));
      knots_.push_back(knots_of(events_[e], s));
      at_.torques.push_back(at_knots(s.torque, knots_.back()));
      at_.fields.push_back(at_knots(s.field, knots_.back()));
    }
  }

  Inference run(int steps) {
    std::vector<EventSensitivities> sensitivities = linearise(at_);
    double cost = prior_cost(at_) + walk_cost(knots_, at_, intensity_);
    for (const auto& e : sensitivities) cost += e.residual.squaredNorm();
    double damping = kFirstDamping;
    int taken = 0;
    while (taken < steps) {
      const Normal normal = normal_of(sensitivities);
      bool moved = false;
      double gained = 0;
      for (int attempt = 0; attempt < kDampings && !moved; ++attempt) {
        const Point to = stepped(normal, damping);
        const double there = cost_at(to);
        if (there < cost) {
          gained = cost - there;
          at_ = to;
          cost = there;
          moved = true;
          damping = std::max(1e-8, 0.2 * damping);
        } else {
          damping *= 8;
        }
      }
      if (!moved) break;
      ++taken;
      sensitivities = linearise(at_);
      if (gained < kWorthAStep) break;
    }
    Inference found;
    found.inputs = inputs_;
    found.criterion = cost + step_of(normal_of(sensitivities)).log_determinant - log_prior(intensity_);
    found.base = tested_.plant;
    for (std::size_t i = 0; i < axes_.size(); ++i)
      parameter_value(found.base, free_[i].id) = axes_[i].value(at_.z[static_cast<Index>(i)]);
    found.plant = plant_at(at_.z);
    found.free = free_;
    found.offset = at_.z;
    found.noise = events_.noise_model();
    found.steps = taken;
    for (std::size_t e = 0; e < events_.size(); ++e) {
      found.states.push_back(state_at(at_, e));
      found.chi2 += sensitivities[e].residual.squaredNorm();
      found.values += events_[e].values();
    }
    found.events = std::move(sensitivities);
    return found;
  }

  /// Returns the most probable intensity of the inputs' random walk, by the quadratic model about an
  /// inference.
  [[nodiscard]] double most_probable_intensity(const Inference& about) const {
    constexpr double kLeastIntensity = 1e-10, kMostIntensity = 1e2, kIntensityFactor = 3.0;
    Normal data = without_walks(about.events, axes_, at_, events_);
    Point none = at_;  // zero inputs have no walk cost, which avoids the cancellation of large numbers
    for (std::size_t e = 0; e < events_.size(); ++e) {
      const Index states = at_.states[e].size(), inputs = data.own[e].rows() - states;
      VectorXd input(inputs);
      if (inputs_.torque) input.head(at_.torques[e].size()) = at_.torques[e];
      if (inputs_.field) input.tail(at_.fields[e].size()) = at_.fields[e];
      data.own_gradient[e] -= data.own[e].rightCols(inputs) * input;
      data.gradient -= data.cross[e].bottomRows(inputs).transpose() * input;
      none.torques[e].setZero();
      none.fields[e].setZero();
    }
    double best = 1.0, least = std::numeric_limits<double>::infinity();
    for (double intensity = kLeastIntensity; intensity < kMostIntensity; intensity *= kIntensityFactor) {
      Normal normal = data;
      add_walks(about.events, none, intensity, normal);
      const detail::Step step = step_of(normal);
      const double criterion = step.log_determinant - log_prior(intensity) - step.falls;
      if (criterion < least) {
        least = criterion;
        best = intensity;
      }
    }
    return best;
  }
  /// Returns the inference at the most probable intensity, with standard deviations of the inputs. The
  /// intensity changes by a factor of at most `farthest` between inferences, because the quadratic model
  /// holds only nearby.
  Inference smoothed(const Inference& first, double farthest) {
    Inference best = first;
    for (int round = 0; round < kIntensities; ++round) {
      const Point at = at_;
      const double intensity = intensity_;
      intensity_ = std::clamp(most_probable_intensity(best), intensity / farthest, intensity * farthest);
      if (std::abs(std::log(intensity_ / intensity)) < kSameIntensity) break;
      Inference next = run(kInferenceSteps);
      if (!(next.criterion < best.criterion)) {
        at_ = at;
        intensity_ = intensity;
        break;
      }
      best = std::move(next);
    }
    add_deviations(best);
    return best;
  }
  /// Adds the posterior standard deviations of the inputs.
  void add_deviations(Inference& found) const {
    const auto all = deviations(normal_of(found.events));
    for (std::size_t e = 0; e < all.size(); ++e) {
      EventSensitivities& s = found.events[e];
      s.torque_deviation = all[e].segment(s.state.cols(), s.torque.cols());
      s.field_deviation = all[e].tail(s.field.cols());
    }
  }

 private:
  static constexpr double kFirstDamping = 1e-3;
  static constexpr int kDampings = 8;
  static constexpr double kWorthAStep = 1.0;  ///< minimum gain of a step to continue [chi2]
  static constexpr double kLongestLog = 0.5;  ///< maximum step of a parameter's coordinate z

  [[nodiscard]] Normal normal_of(const std::vector<EventSensitivities>& sensitivities) const {
    Normal normal = without_walks(sensitivities, axes_, at_, events_);
    add_walks(sensitivities, at_, intensity_, normal);
    return normal;
  }
  /// Returns the input's values at its knots if it has as many knots as `knots`; otherwise zeros.
  [[nodiscard]] static VectorXd at_knots(const playin::PiecewiseLinear& input, const Knots& knots) {
    if (input.t.size() != knots.t.size()) return VectorXd::Zero(static_cast<Index>(knots.t.size()));
    return Eigen::Map<const VectorXd>(input.value.data(), static_cast<Index>(input.value.size()));
  }
  [[nodiscard]] sim::plant::Plant plant_at(const VectorXd& z) const {
    sim::plant::Plant plant = simulated_;
    for (std::size_t i = 0; i < axes_.size(); ++i)
      if (ids_[i]) parameter_value(plant, *ids_[i]) = axes_[i].value(z[static_cast<Index>(i)]);
    return plant;
  }
  [[nodiscard]] event::EventState state_at(const Point& p, std::size_t e) const {
    event::EventState s = fit::event_state(events_[e], p.states[e].data());
    const Knots knots = knots_of_moved(e, s);
    if (inputs_.torque) s.torque = {knots.t, {p.torques[e].begin(), p.torques[e].end()}};
    if (inputs_.field) s.field = {knots.t, {p.fields[e].begin(), p.fields[e].end()}};
    return s;
  }
  /// Returns the knots of event `e`. The knots at switching times are moved to the switching times of the
  /// state `s`.
  [[nodiscard]] Knots knots_of_moved(std::size_t e, const event::EventState& s) const {
    Knots knots = knots_[e];
    if (s.switchings.empty()) return knots;
    knots.t.front() = s.switchings.front();
    for (std::size_t j = 0; j < knots.discontinuities.size(); ++j) {
      knots.t[knots.discontinuities[j]] = s.switchings[j + 1] - sim::plant::kBeforeSwitching;
      knots.t[knots.discontinuities[j] + 1] = s.switchings[j + 1];
    }
    return knots;
  }
  [[nodiscard]] std::vector<EventSensitivities> linearise(const Point& p) const {
    std::vector<EventSensitivities> all(events_.size());
    const sim::plant::Plant plant = plant_at(p.z);
    in_parallel(
        events_.size(), [&](std::size_t e) { all[e] = event_sensitivities(p, plant, e); }, [](int) {},
        threads_);
    return all;
  }
  [[nodiscard]] EventSensitivities event_sensitivities(const Point& p, const sim::plant::Plant& plant,
                                                       std::size_t e) const {
    const event::FitEvent& event = events_[e];
    const event::EventState state = state_at(p, e);
    std::vector<playin::SensitivityParameter> along;
    std::vector<Index> numbers;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      if (!ids_[i]) continue;
      numbers.push_back(static_cast<Index>(i));
      along.push_back({.kind = Kind::parameter,
                       .parameter = *ids_[i],
                       .scale = axes_[i].derivative(p.z[static_cast<Index>(i)])});
    }
    std::ranges::move(fit::state_parameters(event), std::back_inserter(along));
    const Index own = p.states[e].size(), knots = p.torques[e].size();
    std::vector<Kind> kinds;
    if (inputs_.torque) kinds.push_back(Kind::torque);
    if (inputs_.field) kinds.push_back(Kind::field);
    for (int k = 0; k < knots; ++k)  // in order of time
      for (const Kind kind : kinds) along.push_back({.kind = kind, .index = k});
    const playin::Response r = event::play({plant, tested_.conventions}, event, state, along);
    noise::RowMatrix columns(event.values(), static_cast<Index>(along.size()) + 1);
    for (std::size_t d = 0; d < along.size(); ++d)
      columns.col(static_cast<Index>(d)) = event.collected(r.sensitivities[d].value, false);
    columns.rightCols(1) = event.collected(r.value, true);
    events_.noise(e).whiten(columns);
    EventSensitivities sensitivities;
    sensitivities.knots = knots_of_moved(e, state);
    const auto n = static_cast<Index>(numbers.size()), width = static_cast<Index>(kinds.size());
    sensitivities.plant = MatrixXd::Zero(columns.rows(), static_cast<Index>(axes_.size()));
    sensitivities.plant(Eigen::all, numbers) = columns.leftCols(n);
    sensitivities.state = columns.middleCols(n, own);
    sensitivities.torque.resize(columns.rows(), 0);
    sensitivities.field.resize(columns.rows(), 0);
    Index first = n + own;
    for (const Kind kind : kinds)
      (kind == Kind::torque ? sensitivities.torque : sensitivities.field) =
          columns(Eigen::all, Eigen::seqN(first++, knots, width));
    sensitivities.residual = columns.rightCols(1);
    sensitivities.state_at = p.states[e];
    return sensitivities;
  }
  /// Returns the cost at a point; infinite if the plant cannot be simulated.
  [[nodiscard]] double cost_at(const Point& p) const {
    const sim::plant::Plant plant = plant_at(p.z);
    if (!playin::can_exist_beside(plant, tested_.plant)) return kInfinite;
    std::vector<double> parts(events_.size(), kInfinite);
    in_parallel(
        events_.size(),
        [&](std::size_t e) {
          try {
            const playin::Response r = event::play({plant, tested_.conventions}, events_[e], state_at(p, e));
            noise::RowMatrix residual = events_[e].collected(r.value, true);
            events_.noise(e).whiten(residual);
            parts[e] = residual.squaredNorm();
          } catch (const InputError&) {  // its cost stays infinite
          }
        },
        [](int) {}, threads_);
    double cost = prior_cost(p) + walk_cost(knots_, p, intensity_);
    for (const double part : parts) cost += std::isfinite(part) ? part : kInfinite;
    return cost;
  }
  [[nodiscard]] double prior_cost(const Point& p) const {
    double cost = 0;
    for (std::size_t i = 0; i < axes_.size(); ++i)
      if (const double prior_sd = axes_[i].prior_sd(); prior_sd > 0)
        cost += std::pow(p.z[static_cast<Index>(i)] / prior_sd, 2);
    for (std::size_t e = 0; e < events_.size(); ++e) {
      const auto priors = own_priors(events_[e]);
      for (std::size_t k = 0; k < priors.size(); ++k)
        if (priors[k] > 0) cost += std::pow(p.states[e][static_cast<Index>(k)] / priors[k], 2);
    }
    return cost;
  }
  /// Returns the log determinant of the prior precision of all free variables.
  [[nodiscard]] double log_prior(double intensity) const {
    double sum = 0;
    for (const fit::Axis& axis : axes_) sum -= axis.prior_sd() > 0 ? 2 * std::log(axis.prior_sd()) : 0.0;
    for (std::size_t e = 0; e < events_.size(); ++e) {
      for (const double b : own_priors(events_[e])) sum -= b > 0 ? 2 * std::log(b) : 0.0;
      for (const event::InputKind kind : {event::InputKind::torque, event::InputKind::field})
        if (kind == event::InputKind::torque ? inputs_.torque : inputs_.field)
          sum += 2 * walk_weights(knots_[e], kind).array().log().sum() -
                 static_cast<double>(knots_[e].t.size()) * std::log(intensity);
    }
    return sum;
  }
  [[nodiscard]] Point stepped(const Normal& normal, double damping) const {
    const detail::Step step = step_of(normal, damping);
    Point to = at_;
    for (Index i = 0; i < step.z.size(); ++i) {
      const fit::Axis& axis = axes_[static_cast<std::size_t>(i)];
      to.z[i] = std::clamp(at_.z[i] + std::clamp(step.z[i], -kLongestLog, kLongestLog),
                           std::min(at_.z[i], axis.z(axis.low)), std::max(at_.z[i], axis.z(axis.high)));
    }
    for (std::size_t e = 0; e < events_.size(); ++e) {
      const VectorXd& own = step.own[e];
      const Index states = at_.states[e].size(), knots = at_.torques[e].size();
      to.states[e] += own.head(states);
      keep_in_range(events_[e], to.states[e]);
      if (inputs_.torque) to.torques[e] += own.segment(states, knots);
      if (inputs_.field) to.fields[e] += own.tail(knots);
    }
    return to;
  }

  static constexpr double kInfinite = 1e300;
  const sim::plant::PlantUnderTest& tested_;
  const noise::WhitenedEvents& events_;
  const std::vector<fit::FreeParameter>& free_;
  Inputs inputs_;
  int threads_;
  double intensity_ = 1.0;  ///< factor on the prior variance of the inputs' random walk [-]
  std::vector<fit::Axis> axes_;
  std::vector<Knots> knots_;
  sim::plant::Plant simulated_;
  std::vector<std::optional<sim::plant::ParameterId>> ids_;  ///< IDs of the free parameters in `simulated_`
  Point at_;
};

}  // namespace

std::vector<double> own_priors(const event::FitEvent& event) {
  constexpr double kKnown = 1e-6;  // prior standard deviation of a known switching time, in its unit
  std::vector<double> priors = fit::state_priors(event);
  for (std::size_t k = 0; k < event.switchings.size(); ++k)
    priors[k] = std::max(kKnown, event.switchings[k].uncertainty / fit::kSwitchScale);
  return priors;
}

void keep_in_range(const event::FitEvent& event, VectorXd& state) {
  for (std::size_t k = 0; k < event.switchings.size(); ++k) {
    const double bound = event.switchings[k].uncertainty * (1 - 2e-3) / fit::kSwitchScale;
    double& switching = state[static_cast<Index>(k)];
    switching = std::clamp(switching, -bound, bound);
  }
}

Eigen::VectorXd walk_weights(const Knots& knots, event::InputKind kind) {
  const bool torque = kind == event::InputKind::torque;
  constexpr double kLeastGap = 1e-6;  // [s]; keeps a torque continuous at a switching time
  VectorXd weight(static_cast<Index>(knots.t.size()));
  weight[0] = 1 / (torque ? kFirstTorque : kFirstField);
  for (Index k = 1; k < weight.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double gap = std::max(kLeastGap, knots.t[at] - knots.t[at - 1]);
    weight[k] = 1 / std::sqrt((torque ? kTorqueWalk : kFieldWalk) * gap);
  }
  if (!torque)
    for (const std::size_t discontinuity : knots.discontinuities)
      weight[static_cast<Index>(discontinuity) + 1] = 1 / kFirstField;
  return weight;
}

Inference infer(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
                const std::vector<fit::FreeParameter>& free, Inputs inputs, int threads, int steps) {
  Inferring inferring(tested, events, free, inputs, threads);
  inferring.begin(tested.plant, {});
  return inferring.run(steps);
}

SmoothInference infer_smooth(const sim::plant::PlantUnderTest& tested, const noise::WhitenedEvents& events,
                             const std::vector<fit::FreeParameter>& free, Inputs inputs, int threads,
                             const fit::Fit* from) {
  Inferring inferring(tested, events, free, inputs, threads);
  inferring.begin(from ? from->plant : tested.plant,
                  from ? states_of(from->events) : std::vector<event::EventState>());
  SmoothInference found{inferring.run(from ? 0 : kInferenceSteps), {}};
  found.smooth = inferring.smoothed(found.prior, from ? kAnyIntensity : kNearIntensity);
  return found;
}

void add_changes(Inference& inference, const noise::WhitenedEvents& events,
                 const sim::Conventions& conventions, std::span<const Change> changes, int threads) {
  in_parallel(
      events.size(),
      [&](std::size_t e) {
        const auto played = [&](const sim::plant::Plant& plant) -> VectorXd {
          noise::RowMatrix residual = events[e].collected(
              event::play({plant, conventions}, events[e], inference.states[e]).value, true);
          events.noise(e).whiten(residual);
          return residual;
        };
        MatrixXd& columns = inference.events[e].changes;
        columns = MatrixXd::Zero(inference.events[e].residual.size(), static_cast<Index>(changes.size()));
        for (std::size_t c = 0; c < changes.size(); ++c) {
          try {
            columns.col(static_cast<Index>(c)) = played(changes[c].to) - played(changes[c].from);
          } catch (const InputError&) {  // the column stays zero
          }
        }
      },
      [](int) {}, threads);
}

Inference linear_about(const sim::plant::Plant& plant, const sim::plant::PlantUnderTest& tested,
                       const noise::WhitenedEvents& events, const std::vector<fit::FreeParameter>& free,
                       const std::vector<event::EventState>& states, Inputs inputs, int threads) {
  Inferring inferring(tested, events, free, inputs, threads);
  inferring.begin(plant, states);
  return inferring.run(0);
}

}  // namespace swingbank::validate::reduced
