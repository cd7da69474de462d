#include "sim/direct/detail/innovations.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace swingbank::sim::direct {
namespace {

template <class T>
using States = std::array<T, kMostFlowing>;
template <class T>
using Voltage = std::array<T, kInputs>;

/// Machine with V and theta played in; angles in the synchronous frame.
template <class T>
class Played {
 public:
  Played(const Effect& machine, const Conventions& conventions, const std::vector<T>& p,
         const std::array<T, kSteady>& steady, bool noise = false)
      : noise_(noise),
        m_(machine, conventions, p, steady[kV0], steady[kP0] / steady[kV0],
           T(0.0) - steady[kQ0] / steady[kV0]) {
    std::ranges::copy(m_.x, start_.begin());
    start_[0] = start_[0] + steady[kTheta0];
    evaluate(start_, Voltage<T>{steady[kV0], steady[kTheta0]});
    Ifd0_ = m_.s.Ifd;
  }
  [[nodiscard]] const States<T>& start() const { return start_; }
  [[nodiscard]] const T& Ifd0() const { return Ifd0_; }  ///< field current of the steady state [pu]
  void evaluate(const States<T>& x, const Voltage<T>& u) {
    std::copy_n(x.begin(), m_.x.size(), m_.x.begin());
    m_.x[0] = x[0] - u[kTheta];
    m_.evaluate(u[kV]);
  }
  /// Returns the compared signals; call after evaluate().
  [[nodiscard]] std::array<T, kOutputs> outputs() const {
    const auto& s = m_.s;
    return {s.Vr * s.Ir, T(0.0) - s.Vr * s.Ii, s.speed, s.Ifd};
  }
  States<T> derivative() {
    m_.derive();
    States<T> dx{};
    std::ranges::copy(m_.dx, dx.begin());
    return dx;
  }
  /// Integrates from the steady state to the first sample after the event.
  States<T> behind_event(const NoisyRecord& r) {
    States<T> x = start_;
    half(x, r.at_event, r.end_of_first, r.first_step);
    correct(x, r.at_first);
    return x;
  }
  /// Integrates from sample k to the next; `first`: derivative() at the sample.
  void step(const NoisyRecord& r, std::size_t k, States<T>& x, const States<T>& first) {
    const Interval& i = r.behind[k];
    if (!i.leaps) return go(x, first, i.middle, r.in[k + 1], r.step);
    go(x, first, mean(r.in[k], i.before), i.before, r.step / 2);
    half(x, i.after, r.in[k + 1], r.step / 2);
    if (const auto leap = r.behind_leap.find(k); leap != r.behind_leap.end()) correct(x, leap->second);
  }
  /// Returns the derivatives at x for another voltage.
  States<T> derivative_at(const States<T>& x, const Inputs& u) {
    evaluate(x, voltage(u));
    return derivative();
  }
  /// Returns the voltage as T. If `noise_` is set, the dual number has the noise of V and theta as two
  /// further sensitivity parameters.
  [[nodiscard]] Voltage<T> voltage(const Inputs& u) const {
    Voltage<T> v = {T(u[kV]), T(u[kTheta])};
    if constexpr (!std::is_same_v<T, double>)
      if (noise_) v[kV].d[kMostFlowing] = v[kTheta].d[kMostFlowing + 1] = 1;
    return v;
  }

 private:
  static void correct(States<T>& x, const Correction& by) {
    for (std::size_t i = 0; i < kMostFlowing; ++i) x[i] = x[i] + T(by[i]);
  }
  static Inputs mean(const Inputs& u, const Inputs& v) {
    return {0.5 * (u[kV] + v[kV]), 0.5 * (u[kTheta] + v[kTheta])};
  }
  void go(States<T>& x, const States<T>& first, const Inputs& middle, const Inputs& last, double h) {
    runge_kutta(x, first, h,
                [&](int stage, const States<T>& y) { return derivative_at(y, stage == 3 ? last : middle); });
  }
  void half(States<T>& x, const Inputs& u, const Inputs& v, double h) {
    go(x, derivative_at(x, u), mean(u, v), v, h);
  }

  bool noise_;
  PlaybackMachine<T> m_;
  States<T> start_{};
  T Ifd0_;
};

using OutputMatrix = Eigen::Matrix<double, kOutputs, kOutputs>;
using StateMatrix = Eigen::Matrix<double, kMostFlowing, kMostFlowing>;
using FromInputs = Eigen::Matrix<double, kMostFlowing, kInputs>;

/// Linearised equations of a sample about the filter's state: y = C x + D n + v, x' = F x + G n. n: noise of
/// the played-in voltage; v: noise of the outputs.
struct Linear {
  StateMatrix F = StateMatrix::Zero();
  FromInputs G = FromInputs::Zero();
  Eigen::Matrix<double, kOutputs, kMostFlowing> C;
  Eigen::Matrix<double, kOutputs, kInputs> D;
  Eigen::Matrix<double, kOutputs, 1> y;
  Gain::State next = Gain::State::Zero();
  FromInputs half = FromInputs::Zero();      ///< effect of a sample's noise on the state before the sample
  StateMatrix unsure = StateMatrix::Zero();  ///< covariance due to a voltage step before the next sample
};

class Linearised {
 public:
  Linearised(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
             const std::array<double, kSteady>& steady)
      : record_(record),
        states_(machine.states.size()),
        played_(machine, record.conventions, {p.begin(), p.end()},
                {steady[kP0], steady[kQ0], steady[kV0], steady[kTheta0]}, true) {}

  /// Returns the state at the first sample and its covariance.
  Gain::State start(StateMatrix& P) {
    // The voltage at the event is extrapolated from two samples, so that its noise exceeds that of one
    // sample.
    constexpr double kExtrapolated = 1.5 * 1.5 + 0.5 * 0.5;
    const auto first = played_.behind_event(record_);
    Linear l;
    take(first, l);
    const double input = kExtrapolated * std::pow(record_.noise.phasor(), 2);
    P = input * l.G * l.G.transpose();
    open(played_.start(), record_.in[0], record_.at_event, kUnsure * record_.first_step, P);
    return l.next;
  }
  Linear at(std::size_t k, const Gain::State& state) {
    Linear l;
    States<D8> x{};
    for (std::size_t i = 0; i < states_; ++i) {
      x[i] = D8(state[static_cast<Eigen::Index>(i)]);
      x[i].d[i] = 1;
    }
    played_.evaluate(x, played_.voltage(record_.in[k]));
    const auto y = played_.outputs();
    for (int o = 0; o < kOutputs; ++o) {
      const auto& value = y[static_cast<std::size_t>(o)];
      l.y[o] = value.a;
      for (std::size_t i = 0; i < kMostFlowing; ++i) l.C(o, static_cast<Eigen::Index>(i)) = value.d[i];
      for (int i = 0; i < kInputs; ++i) l.D(o, i) = value.d[kMostFlowing + static_cast<std::size_t>(i)];
    }
    if (k + 1 >= record_.samples()) return l;
    const auto derivative = played_.derivative();
    const auto before = x;
    played_.step(record_, k, x, derivative);
    take(x, l);
    if (record_.behind[k].leaps) leap(before, k, l);
    halve(l);
    return l;
  }

 private:
  /// Relative uncertainty of an extrapolated difference.
  static constexpr double kUnsure = 0.25;

  void take(const States<D8>& x, Linear& l) const {
    for (std::size_t i = 0; i < states_; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      l.next[row] = x[i].a;
      for (std::size_t j = 0; j < kMostFlowing; ++j) l.F(row, static_cast<Eigen::Index>(j)) = x[i].d[j];
      for (int j = 0; j < kInputs; ++j) l.G(row, j) = x[i].d[kMostFlowing + static_cast<std::size_t>(j)];
    }
  }
  /// Half of the effect of a sample's noise occurs before the sample, half after it. The state excludes the
  /// first half, so that the equations keep their form.
  static void halve(Linear& l) {
    l.half = 0.5 * l.G;
    l.D += 0.5 * l.C * l.G;
    l.G = (0.5 * (l.F * l.G + l.G)).eval();
  }
  /// Adds the covariance of the state if it is unknown whether the voltage was u or v during `h` [s].
  void open(const States<D8>& x, const Inputs& u, const Inputs& v, double h, StateMatrix& covariance) {
    const auto a = played_.derivative_at(x, u), b = played_.derivative_at(x, v);
    Gain::State moved = Gain::State::Zero();
    for (std::size_t i = 0; i < states_; ++i) moved[static_cast<Eigen::Index>(i)] = h * (a[i].a - b[i].a);
    covariance += moved * moved.transpose();
  }
  /// Adds the covariance of a voltage step at an unknown time between two samples. A uniform distribution of
  /// this time has the variance step^2/12. The extrapolated voltages on both sides are uncertain as well.
  void leap(const States<D8>& x, std::size_t k, Linear& l) {
    const Interval& i = record_.behind[k];
    open(x, i.before, i.after, record_.step / std::sqrt(12.0), l.unsure);
    open(x, i.before, record_.in[k], kUnsure * record_.step / 2, l.unsure);
    open(x, i.after, record_.in[k + 1], kUnsure * record_.step / 2, l.unsure);
  }

  const NoisyRecord& record_;
  std::size_t states_;
  Played<D8> played_;
};

/// Returns the variances of the noise of the compared outputs.
Eigen::Matrix<double, kOutputs, 1> variances(const MeasurementNoise& noise, double Ifd) {
  Eigen::Matrix<double, kOutputs, 1> v;
  v << noise.phasor(), noise.phasor(), noise.speed(), noise.field(Ifd);
  return v.cwiseAbs2();
}

using OutputVector = Eigen::Matrix<double, kOutputs, 1>;

/// Filter step of one sample, stored for the backward pass.
struct Step {
  Linear l;
  OutputVector weighed;  ///< innovation divided by its covariance
};

OutputVector innovation(const NoisyRecord& record, std::size_t k, const Linear& l) {
  OutputVector e;
  for (int o = 0; o < kOutputs; ++o) e[o] = record.out[k][static_cast<std::size_t>(o)] - l.y[o];
  if (record.outputs < kOutputs) e[kIfd] = 0;
  return e;
}

OutputMatrix covariance(const NoisyRecord& record, const Linear& l, const StateMatrix& P) {
  const double input = record.noise.phasor() * record.noise.phasor();
  OutputMatrix S = l.C * P * l.C.transpose() + input * l.D * l.D.transpose();
  S.diagonal() += variances(record.noise, l.y[kIfd]);
  if (record.outputs < kOutputs) {  // not recorded: as if measured with infinite variance
    S.row(kIfd).setZero();
    S.col(kIfd).setZero();
    S(kIfd, kIfd) = 1;
  }
  return S;
}

Correction correction(const Gain::State& x) {
  Correction c;
  std::ranges::copy(x, c.begin());
  return c;
}

/// Returns the record without its most probable noise, by a backward pass (disturbance smoother, de Jong).
NoisyRecord without_noise(const NoisyRecord& record, const std::vector<Step>& steps,
                          const std::vector<Gain>& gains, const StateMatrix& P0) {
  NoisyRecord likely = record;
  const double input = record.noise.phasor() * record.noise.phasor();
  Gain::State back = Gain::State::Zero();
  Eigen::Matrix<double, kInputs, 1> noise;
  for (std::size_t k = steps.size(); k-- > 0;) {
    const auto& [l, weighed] = steps[k];
    const auto& K = gains[k].onto_states;
    if (k < record.behind.size() && record.behind[k].leaps)
      likely.behind_leap[k] = correction(l.unsure * back);
    const OutputVector own = weighed - K.transpose() * back;
    noise = -input * (l.D.transpose() * own + l.G.transpose() * back);
    for (int c = 0; c < kInputs; ++c) likely.in[k][static_cast<std::size_t>(c)] -= noise[c];
    back = (l.C.transpose() * own + l.F.transpose() * back).eval();
  }
  likely.at_first = correction(P0 * back - steps.front().l.half * noise);
  fill_intervals(likely);
  return likely;
}

/// Computes the machine's response to the played-in record.
void show(Played<double> m, NoisyRecord& record) {
  auto x = m.behind_event(record);
  for (std::size_t k = 0; k < record.samples(); ++k) {
    m.evaluate(x, m.voltage(record.in[k]));
    record.out[k] = m.outputs();
    if (k + 1 < record.samples()) m.step(record, k, x, m.derivative());
  }
}

}  // namespace

Filtered filter(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
                const std::array<double, kSteady>& steady) {
  Filtered f;
  f.gains.resize(record.samples());
  f.white.resize(record.samples());
  std::vector<Step> steps(record.samples());
  Linearised linearised(machine, record, p, steady);
  const double input = record.noise.phasor() * record.noise.phasor();
  StateMatrix P0;
  Gain::State x = linearised.start(P0);
  StateMatrix P = P0;
  for (std::size_t k = 0; k < record.samples(); ++k) {
    auto& [l, weighed] = steps[k];
    l = linearised.at(k, x);
    const OutputVector e = innovation(record, k, l);
    const OutputMatrix S = covariance(record, l, P);
    const Eigen::LLT<OutputMatrix> factor(S);
    Gain& gain = f.gains[k];
    gain.whitening = factor.matrixL().solve(OutputMatrix::Identity());
    gain.onto_states =
        factor.solve((l.F * P * l.C.transpose() + input * l.G * l.D.transpose()).transpose()).transpose();
    if (record.outputs < kOutputs) gain.onto_states.col(kIfd).setZero();
    f.white[k] = gain.whitening * e;
    weighed = gain.whitening.transpose() * f.white[k];
    P = l.F * P * l.F.transpose() + input * l.G * l.G.transpose() + l.unsure -
        gain.onto_states * S * gain.onto_states.transpose();
    P = (0.5 * (P + P.transpose())).eval();
    x = l.next + gain.onto_states * e;
  }
  f.likely = without_noise(record, steps, f.gains, P0);
  show({machine, record.conventions, p, steady}, f.likely);
  return f;
}

std::size_t innovation_count(const NoisyRecord& record) {
  const auto outputs = static_cast<std::size_t>(record.outputs);
  return record.samples() * outputs + kSteady + (record.outputs == kOutputs ? 1 : 0);
}

template <class T>
void innovations(const Effect& machine, const NoisyRecord& r, const std::vector<Gain>& gains,
                 const std::vector<T>& p, const std::array<T, kSteady>& steady, T* out) {
  Played<T> m(machine, r.conventions, p, steady);
  // The noise of a mean before the event equals the noise of one sample, divided by the square root of the
  // number of samples.
  const double mean = std::sqrt(r.before) / r.noise.phasor();
  *out++ = T(mean) * (T(r.P0) - steady[kP0]);
  *out++ = T(mean) * (T(r.Q0) - steady[kQ0]);
  *out++ = T(mean) * (T(r.V0) - steady[kV0]);
  *out++ = T(mean) * (T(0.0) - steady[kTheta0]);
  if (r.outputs == kOutputs) *out++ = T(std::sqrt(r.before) / r.noise.field(r.Ifd0)) * (T(r.Ifd0) - m.Ifd0());
  const std::size_t states = machine.states.size();
  States<T> x = m.behind_event(r);
  for (std::size_t k = 0; k < r.samples(); ++k) {
    m.evaluate(x, m.voltage(r.in[k]));
    const auto y = m.outputs();
    std::array<T, kOutputs> e{};
    for (std::size_t o = 0; o < static_cast<std::size_t>(r.outputs); ++o) e[o] = T(r.out[k][o]) - y[o];
    const Gain& gain = gains[k];
    for (int o = 0; o < r.outputs; ++o) {
      T white(0.0);
      for (int i = 0; i <= o; ++i) white = white + T(gain.whitening(o, i)) * e[static_cast<std::size_t>(i)];
      *out++ = white;
    }
    if (k + 1 == r.samples()) break;
    m.step(r, k, x, m.derivative());
    for (std::size_t i = 0; i < states; ++i)
      for (int o = 0; o < r.outputs; ++o)
        x[i] = x[i] + T(gain.onto_states(static_cast<Eigen::Index>(i), o)) * e[static_cast<std::size_t>(o)];
  }
}

template void innovations(const Effect&, const NoisyRecord&, const std::vector<Gain>&,
                          const std::vector<double>&, const std::array<double, kSteady>&, double*);
template void innovations(const Effect&, const NoisyRecord&, const std::vector<Gain>&, const std::vector<D8>&,
                          const std::array<D8, kSteady>&, D8*);

}  // namespace swingbank::sim::direct
