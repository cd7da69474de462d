#include "validate/calibrate/detail/identify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/constants.hpp"
#include "validate/noise/slow_noise.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::calibrate {
namespace {

constexpr double kTriedSeconds = 20.0;  ///< length of a simulated event [s]
constexpr double kAt = 2.0;             ///< start of the disturbance [s]

/// Builder of simulated events with a given voltage, at the operating point of a recorded event.
class Trial {
 public:
  Trial(const event::FitEvent& like, const std::vector<double>& switchings) : event_(like) {
    record::Record& r = event_.record;
    const double step = r.step(), first = r.t.front();
    r.t.clear();
    for (int k = 0; k * step <= kTriedSeconds; ++k) r.t.push_back(first + k * step);
    event_.switchings.clear();
    for (const double t : switchings)  // they lie between samples, as in real records
      event_.switchings.push_back(
          {.time = first + std::floor(t / step) * step + 0.4 * step, .uncertainty = 0.5 * step});
    event_.start.drift = 0;
    event_.filtered_samples.clear();
    event_.left_out.clear();
  }
  /// Returns the event. `voltage(t)`: V relative to that of the operating point; `frequency(t)`: frequency
  /// deviation [Hz].
  template <class V, class F>
  event::FitEvent with(V voltage, F frequency) {
    record::Record& r = event_.record;
    const double V0 = std::abs(event_.start.voltage);
    double theta = std::arg(event_.start.voltage);
    r.V.clear();
    r.theta.clear();
    for (const double t : r.t) {
      r.V.push_back(V0 * voltage(t - r.t.front()));
      r.theta.push_back(theta);
      theta += constants::turn * frequency(t - r.t.front()) * r.step();
    }
    for (auto* channel : {&r.P, &r.Q, &r.speed, &r.Efd, &r.Ifd}) channel->assign(r.t.size(), 0.0);
    return event_;
  }

 private:
  event::FitEvent event_;
};

event::FitEvent frequency_event(const event::FitEvent& like) {
  return Trial(like, {}).with(
      [](double) { return 1.0; },
      [](double t) { return t < kAt ? 0.0 : -0.3 * (1 - std::exp(-(t - kAt) / 1.5)); });
}
event::FitEvent deep_fault(const event::FitEvent& like) {
  const double end = kAt + 0.15;
  return Trial(like, {kAt, end})
      .with(
          [end](double t) {
            return t <= kAt ? 1.0 : t <= end ? 0.2 : 1.0 - 0.1 * std::exp(-(t - end) / 0.5);
          },
          [](double) { return 0.0; });
}
event::FitEvent voltage_step(const event::FitEvent& like) {
  return Trial(like, {kAt}).with([](double t) { return t <= kAt ? 1.0 : 0.97; }, [](double) { return 0.0; });
}

/// Voltage rise as after a load rejection.
event::FitEvent voltage_rise(const event::FitEvent& like) {
  const double end = kAt + 3.0;
  return Trial(like, {kAt, end})
      .with([end](double t) { return t <= kAt || t > end ? 1.0 : 1.15; }, [](double) { return 0.0; });
}

/// Returns the event with the channels speed, Efd and Ifd in place of the recorded ones.
event::FitEvent inner_channels(event::FitEvent event) {
  event.channels = {playin::Output::speed, playin::Output::Efd, playin::Output::Ifd};
  for (auto* channel : {&event.record.speed, &event.record.Efd, &event.record.Ifd})
    channel->assign(event.record.t.size(), 0.0);
  return event;
}
noise::EventNoise inner_noise() {
  noise::EventNoise noise;
  noise.deviation.resize(3);
  noise.deviation << 2e-5, 2e-3, 2e-3;  // [pu]: 1 mHz, 0.2 %
  noise.whitening = noise.deviation.cwiseInverse().asDiagonal();
  return noise;
}

}  // namespace

std::vector<UnidentifiedCombination> find_unidentified(const Eigen::MatrixXd& information,
                                                       const Eigen::VectorXd& unit) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  std::vector<UnidentifiedCombination> unidentified;
  for (Eigen::Index k = 0; k < information.rows(); ++k) {
    const double value = std::max(0.0, eigen.eigenvalues()[k]), decided = value / (1 + value);
    if (decided >= thresholds::parameters.identified) break;  // later eigenvalues are larger
    const Eigen::VectorXd v = eigen.eigenvectors().col(k);
    UnidentifiedCombination combination;
    combination.decided = decided;
    for (Eigen::Index i = 0; i < v.size(); ++i)
      if (std::abs(v[i]) >= thresholds::parameters.member)
        combination.members.push_back({static_cast<int>(i), v[i] * unit[i] / std::sqrt(1 + value)});
    std::ranges::sort(combination.members, std::ranges::greater{},
                      [&](const UnidentifiedCombination::Member& m) { return std::abs(v[m.parameter]); });
    unidentified.push_back(combination);
  }
  return unidentified;
}

std::vector<TriedEvent> try_events(const sim::plant::PlantUnderTest& tested,
                                   const noise::WhitenedEvents& events,
                                   const std::vector<fit::EventState>& states,
                                   const noise::VoltageNoise& voltage,
                                   const std::vector<fit::FreeParameter>& free) {
  std::vector<TriedEvent> tried;
  const event::FitEvent& like = events.front();
  // The additional inputs of a component or a staged test (Vref, Pref) are unknown in a simulated event.
  if (like.record.component != record::Component::plant || !like.record.staged.empty()) return tried;
  const auto learnt = [&](const event::FitEvent& event, noise::EventNoise noise,
                          const fit::EventState& state) {
    noise.memory = noise::memory_of(tested, {event, noise}, voltage);
    return fit::information(fit::event_sensitivities(tested, {event, noise}, state, free));
  };
  const auto attempt = [&](const std::string& what, const event::FitEvent& event,
                           const fit::EventState& state) {
    try {
      tried.push_back({what, learnt(event, events.noise(0), state)});
    } catch (const InputError&) {  // the plant cannot be simulated through that event
    }
  };
  const double V = std::abs(like.start.voltage);
  for (const auto& [what, event] : {
           std::pair{std::string("a frequency event (-0.3 Hz within 5 s)"), frequency_event(like)},
           std::pair{fmt::format("a deep fault (V to {:.2f} pu for 0.15 s)", 0.2 * V), deep_fault(like)},
           std::pair{fmt::format("a permanent voltage step (−3 %, to {:.3f} pu)", 0.97 * V),
                     voltage_step(like)},
           std::pair{fmt::format("a load rejection (V up by 15 %, to {:.2f} pu, for 3 s)", 1.15 * V),
                     voltage_rise(like)},
       })
    attempt(what, event, event::prepared_state(event));
  if (std::ranges::count(like.channels, playin::Output::Ifd) == 0) {
    TriedEvent inner{"the same events with speed, Efd and Ifd recorded", {}};
    inner.information =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(free.size()), static_cast<Eigen::Index>(free.size()));
    for (std::size_t e = 0; e < events.size(); ++e)
      inner.information += learnt(inner_channels(events[e]), inner_noise(), states[e]);
    tried.push_back(inner);
  }
  return tried;
}

}  // namespace swingbank::validate::calibrate
