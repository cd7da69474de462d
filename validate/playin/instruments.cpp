#include "validate/playin/instruments.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/plant/measure.hpp"

namespace swingbank::validate::playin {
namespace {

using Kind = SensitivityParameter::Kind;

/// Step of a parameter for central differences, as a fraction of its range. The result hardly depends on this
/// step.
constexpr double kMove = 1e-5;

/// Returns the lag of an angle that is integrated from the chain's frequency [s].
double angle_lag(const std::vector<sim::plant::Block>& chain) {
  double lag = 0;
  for (const sim::plant::Block& b : chain)
    if (b.effect->angle_lag) lag += b.effect->angle_lag(b.p.data());
  return lag;
}

/// Gain of the chain of instruments for constant phasors.
struct SteadyGain {
  Complex V = 1, I = 1;
};

sim::Phasors phasors(const std::vector<Complex>& V, const std::vector<double>& P,
                     const std::vector<double>& Q, double rate, double frequency) {
  sim::Phasors p{rate, frequency, V, {}, std::vector<double>(V.size(), 0.0)};
  for (std::size_t k = 0; k < V.size(); ++k) p.I.push_back(std::conj(Complex(P[k], Q[k]) / V[k]));
  return p;
}

SteadyGain steady_gain(const std::vector<sim::plant::Block>& chain, double rate, double frequency) {
  const auto beside = static_cast<std::size_t>(std::ceil(sim::plant::memory(chain) * rate)) + 2;
  const std::vector<Complex> one(2 * beside + 1, 1.0);
  sim::Phasors p{rate, frequency, one, one, std::vector<double>(one.size(), 0.0)};
  sim::plant::measure(chain, 1, p);
  return {p.V[beside], p.I[beside]};
}

/// P and Q after the chain, every `stride`-th value.
struct Power {
  std::vector<double> P, Q;
};
Power measured(const std::vector<sim::plant::Block>& chain, sim::Phasors p, std::size_t stride) {
  sim::plant::measure(chain, 1, p);
  Power power;
  for (std::size_t k = 0; k < p.V.size(); k += stride) {
    const Complex s = p.V[k] * std::conj(p.I[k]);
    power.P.push_back(s.real());
    power.Q.push_back(s.imag());
  }
  return power;
}

template <class T>
void thin(std::vector<T>& values, std::size_t stride) {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < values.size(); k += stride) values[kept++] = values[k];
  values.resize(kept);
}

/// One run and its sensitivities.
class Observed {
 public:
  /// `parameters` must not include parameters of the instruments.
  Observed(const PlaybackRun& run, std::span<const SensitivityParameter> parameters)
      : run_(run), chain_(run.plant->measurements), inner_(run), parameters_(parameters) {
    const record::Record& r = *run.record;
    const double rate = 1 / r.step(), frequency = run.conventions.frequency;
    const SteadyGain gain = gain_ = steady_gain(chain_, rate, frequency);
    back_ = 1.0 / (gain.V * std::conj(gain.I));
    inner_.voltage_factor = run.voltage_factor / gain.V;
    inner_.start.voltage = run.start.voltage / gain.V;
    const Complex power = Complex(run.start.P, run.start.Q) * back_;
    inner_.start.P = power.real();
    inner_.start.Q = power.imag();
    if (const double lag = angle_lag(chain_); lag != 0 && r.angle == record::AngleSource::integrated) {
      advanced_.emplace(run.curve->advanced(lag));
      inner_.curve = &*advanced_;
      inner_.start.voltage *= std::polar(1.0, lag * run.start.drift);
    }
    if (sim::plant::memory(chain_) > 0) refine(r);
  }
  Response run() {
    Response r = simulate_playback(inner_, parameters_);
    turn_starts(r);
    const double rate = fine_rate(), frequency = run_.conventions.frequency;
    auto& P = r.value[static_cast<int>(Output::P)];
    auto& Q = r.value[static_cast<int>(Output::Q)];
    shown_ = phasors(r.voltage, P, Q, rate, frequency);
    const Power seen = measured(chain_, shown_, stride_);
    for (auto& sensitivity : r.sensitivities) {
      auto& dP = sensitivity.value[static_cast<int>(Output::P)];
      auto& dQ = sensitivity.value[static_cast<int>(Output::Q)];
      double largest = 1e-12;
      for (std::size_t k = 0; k < dP.size(); ++k)
        largest = std::max({largest, std::abs(dP[k]), std::abs(dQ[k])});
      const double step = 1e-6 / largest;
      std::vector<double> movedP(P), movedQ(Q);
      for (std::size_t k = 0; k < P.size(); ++k) {
        movedP[k] += step * dP[k];
        movedQ[k] += step * dQ[k];
      }
      const Power moved = measured(chain_, phasors(r.voltage, movedP, movedQ, rate, frequency), stride_);
      for (auto& values : sensitivity.value) thin(values, stride_);
      for (std::size_t k = 0; k < seen.P.size(); ++k) {
        dP[k] = (moved.P[k] - seen.P[k]) / step;
        dQ[k] = (moved.Q[k] - seen.Q[k]) / step;
      }
    }
    for (auto& values : r.value) thin(values, stride_);
    thin(r.voltage, stride_);
    P = seen.P;
    Q = seen.Q;
    return r;
  }
  /// Returns the sensitivity to a parameter of an instrument, after run(). If the parameter does not change
  /// the gain for constant phasors, the plant's run is unchanged, and only the instruments' outputs are
  /// recomputed.
  [[nodiscard]] Response::Sensitivity along(const SensitivityParameter& d) const {
    const auto& record = sim::plant::parameter_record(*run_.plant, d.parameter);
    const double move = kMove * (record.high - record.low);
    sim::plant::Plant above = *run_.plant, below = above;
    sim::plant::parameter_value(above, d.parameter) += move;
    sim::plant::parameter_value(below, d.parameter) -= move;
    if (!(has_same_gain(above) && has_same_gain(below))) return along_both(d, above, below, move);
    const Power more = measured(above.measurements, shown_, stride_),
                less = measured(below.measurements, shown_, stride_);
    Response::Sensitivity sensitivity;
    for (auto& values : sensitivity.value) values.assign(more.P.size(), 0.0);
    for (std::size_t k = 0; k < more.P.size(); ++k) {
      sensitivity.value[static_cast<int>(Output::P)][k] = d.scale * (more.P[k] - less.P[k]) / (2 * move);
      sensitivity.value[static_cast<int>(Output::Q)][k] = d.scale * (more.Q[k] - less.Q[k]) / (2 * move);
    }
    return sensitivity;
  }

 private:
  [[nodiscard]] double fine_rate() const { return static_cast<double>(stride_) / run_.record->step(); }
  [[nodiscard]] bool has_same_gain(const sim::plant::Plant& moved) const {
    const SteadyGain gain =
        steady_gain(moved.measurements, 1 / run_.record->step(), run_.conventions.frequency);
    return gain.V == gain_.V && gain.I == gain_.I && angle_lag(moved.measurements) == angle_lag(chain_) &&
           (sim::plant::memory(moved.measurements) > 0) == (stride_ > 1);
  }
  [[nodiscard]] Response::Sensitivity along_both(const SensitivityParameter& d,
                                                 const sim::plant::Plant& above,
                                                 const sim::plant::Plant& below, double move) const {
    const auto of = [&](const sim::plant::Plant& plant) {
      PlaybackRun moved = run_;
      moved.plant = &plant;
      moved.cache = nullptr;
      return Observed(moved, {}).run();
    };
    const Response more = of(above), less = of(below);
    Response::Sensitivity sensitivity;
    for (int o = 0; o < kOutputs; ++o)
      for (std::size_t k = 0; k < more.value[o].size(); ++k)
        sensitivity.value[o].push_back(d.scale * (more.value[o][k] - less.value[o][k]) / (2 * move));
    return sensitivity;
  }
  void refine(const record::Record& r) {
    stride_ = kOversampling;
    fine_.name = r.name;
    fine_.base = r.base;
    for (std::size_t k = 0; k + 1 < r.t.size(); ++k)
      for (int i = 0; i < kOversampling; ++i)
        fine_.t.push_back(r.t[k] + (r.t[k + 1] - r.t[k]) * i / kOversampling);
    fine_.t.push_back(r.t.back());
    inner_.record = &fine_;
    inner_.step_limit = run_.step_limit * kOversampling;
  }
  /// Converts the sensitivities to the plant's initial P and Q into sensitivities to the measured initial P
  /// and Q.
  void turn_starts(Response& r) const {
    const auto find = [&](Kind kind) {
      return std::ranges::find(parameters_, kind, &SensitivityParameter::kind) - parameters_.begin();
    };
    const auto p = static_cast<std::size_t>(find(Kind::P)), q = static_cast<std::size_t>(find(Kind::Q));
    if (p == parameters_.size() || q == parameters_.size()) return;
    const double toP = parameters_[p].scale, toQ = parameters_[q].scale;
    for (int o = 0; o < kOutputs; ++o)
      for (std::size_t k = 0; k < r.sensitivities[p].value[o].size(); ++k) {
        double &a = r.sensitivities[p].value[o][k], &b = r.sensitivities[q].value[o][k];
        const double byP = a / toP, byQ = b / toQ;
        a = toP * (back_.real() * byP + back_.imag() * byQ);
        b = toQ * (back_.real() * byQ - back_.imag() * byP);
      }
  }

  const PlaybackRun& run_;
  const std::vector<sim::plant::Block>& chain_;
  PlaybackRun inner_;
  std::span<const SensitivityParameter> parameters_;
  record::Record fine_;
  std::optional<VoltageCurve> advanced_;  ///< played-in voltage with the lag of its angle removed
  SteadyGain gain_;
  sim::Phasors shown_;  ///< inputs of the chain
  Complex back_ = 1;    ///< ratio of power in the plant to measured power, for constant phasors
  std::size_t stride_ = 1;
};

}  // namespace

Response observe(const PlaybackRun& run, std::span<const SensitivityParameter> parameters) {
  if (run.plant->measurements.empty()) return simulate_playback(run, parameters);
  const int first = sim::plant::first_measurement(*run.plant);
  const auto instrument = [&](const SensitivityParameter& d) {
    return d.kind == Kind::parameter && d.parameter.block >= first;
  };
  std::vector<SensitivityParameter> others;
  std::ranges::copy_if(parameters, std::back_inserter(others),
                       [&](const SensitivityParameter& d) { return !instrument(d); });
  Observed observed(run, others);
  Response r = observed.run();
  std::vector<Response::Sensitivity> sensitivities;
  std::size_t next = 0;
  for (const SensitivityParameter& d : parameters)
    sensitivities.push_back(instrument(d) ? observed.along(d) : std::move(r.sensitivities[next++]));
  r.sensitivities = std::move(sensitivities);
  return r;
}

namespace {

constexpr int kProbeSamples = 64;

/// Returns the test signal of an instrument: phasors whose magnitude and angle change with time.
sim::Phasors probe() {
  constexpr double kRate = 240.0;
  sim::Phasors p{kRate, 60.0, {}, {}, std::vector<double>(kProbeSamples, 0.0)};
  for (int k = 0; k < kProbeSamples; ++k) {
    p.V.push_back(std::polar(1.0 + 1e-3 * k, 2e-3 * k));
    p.I.push_back(std::polar(0.7 - 2e-3 * k, 1e-3 * k));
  }
  return p;
}
/// Returns parameters of the instrument that differ from their null values by far more than rounding errors.
std::vector<double> away_from_null(const sim::Effect& instrument) {
  constexpr double kAway = 0.05;  // of the range
  auto p = instrument.default_parameters();
  for (std::size_t i = 0; i < p.size(); ++i)
    if (const auto& record = instrument.parameters[i]; !record.is_code())
      p[i] = std::clamp(p[i] + kAway * (record.high - record.low), record.low, record.high);
  return p;
}

}  // namespace

bool changes_playback(const sim::Effect& instrument, bool integrated_angle) {
  if (integrated_angle && instrument.angle_lag) return true;
  const sim::Phasors before = probe();
  sim::Phasors after = before;
  instrument.measure(away_from_null(instrument).data(), 1, after);
  return after.V != before.V || after.I != before.I;
}

bool can_be_taken_back(const sim::Effect& instrument) {
  const auto p = away_from_null(instrument);
  sim::Phasors once = probe();
  const auto before = once.V;
  sim::Phasors twice = once;
  for (auto* channel : {&twice.V, &twice.I})
    for (auto& x : *channel) x *= 2.0;
  instrument.measure(p.data(), 1, once);
  instrument.measure(p.data(), 2, twice);
  for (std::size_t k = 0; k < kProbeSamples; ++k)
    if (!(std::abs(twice.V[k] - 2.0 * once.V[k]) < 1e-9 && std::abs(twice.I[k] - 2.0 * once.I[k]) < 1e-9))
      return false;
  for (std::size_t k = 0; k < kProbeSamples; ++k)
    if (!(std::abs(once.V[k] / before[k] - once.V[0] / before[0]) < 1e-9)) return false;
  return true;
}

}  // namespace swingbank::validate::playin
