#include "sim/direct/detail/innovations.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace swingbank::sim::direct {
namespace {

template <class T>
using States = std::array<T, kMostStates>;
template <class T>
using Inputs = std::array<T, kInputs>;

/// The machine with V and theta played in; angles in the synchronous frame.
template <class T>
class Played {
 public:
  Played(const Effect& machine, const Conventions& conventions, const std::vector<T>& p,
         const std::array<T, kSteady>& steady)
      : m_(machine, conventions, p, steady[kV0], steady[kP0] / steady[kV0],
           T(0.0) - steady[kQ0] / steady[kV0]) {
    std::ranges::copy(m_.x, start_.begin());
    start_[0] = start_[0] + steady[kTheta0];
    evaluate(start_, {steady[kV0], steady[kTheta0]});
    Ifd0_ = m_.s.Ifd;
  }
  [[nodiscard]] const States<T>& start() const { return start_; }
  [[nodiscard]] const T& Ifd0() const { return Ifd0_; }  ///< of the steady state
  void evaluate(const States<T>& x, const Inputs<T>& u) {
    std::copy_n(x.begin(), m_.x.size(), m_.x.begin());
    m_.x[0] = x[0] - u[kTheta];
    m_.evaluate(u[kV]);
  }
  /// Behind evaluate().
  [[nodiscard]] std::array<T, kOutputs> outputs() const {
    const auto& s = m_.s;
    return {s.Vr * s.Ir, T(0.0) - s.Vr * s.Ii, s.speed, s.Ifd};
  }
  States<T> slope() {
    m_.derive();
    States<T> dx{};
    std::ranges::copy(m_.dx, dx.begin());
    return dx;
  }
  /// From u to v in h seconds, straight between; `first`: slope() at the start.
  void step(States<T>& x, const States<T>& first, const Inputs<T>& u, const Inputs<T>& v, double h) {
    const Inputs<T> middle = {T(0.5) * (u[kV] + v[kV]), T(0.5) * (u[kTheta] + v[kTheta])};
    runge_kutta(x, first, h, [&](int stage, const States<T>& y) {
      evaluate(y, stage == 3 ? v : middle);
      return slope();
    });
  }
  /// From the steady state to the first sample behind the event, with that sample's voltage throughout.
  States<T> behind_event(const Inputs<T>& u, double h) {
    States<T> x = start_;
    evaluate(x, u);
    step(x, slope(), u, u, h);
    return x;
  }

 private:
  DrivenMachine<T> m_;
  States<T> start_{};
  T Ifd0_;
};

template <class T>
Inputs<T> played(const NoisyRecord& r, std::size_t k) {
  return {T(r.in[k][kV]), T(r.in[k][kTheta])};
}

using OutputMatrix = Eigen::Matrix<double, kOutputs, kOutputs>;
using StateMatrix = Eigen::Matrix<double, kMostStates, kMostStates>;
using FromInputs = Eigen::Matrix<double, kMostStates, kInputs>;

/// A sample's equations about the filter's state: y = C x + D n + v, x' = F x + G n.
struct Linear {
  StateMatrix F = StateMatrix::Zero();
  FromInputs G = FromInputs::Zero();
  Eigen::Matrix<double, kOutputs, kMostStates> C;
  Eigen::Matrix<double, kOutputs, kInputs> D;
  Eigen::Matrix<double, kOutputs, 1> y;
  Gain::State next = Gain::State::Zero(), leap = Gain::State::Zero();
};

class Linearised {
 public:
  Linearised(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
             const std::array<double, kSteady>& steady)
      : record_(record),
        states_(machine.states.size()),
        played_(machine, record.conventions, {p.begin(), p.end()},
                {steady[kP0], steady[kQ0], steady[kV0], steady[kTheta0]}) {}

  /// The state at the first sample, and what that sample's noise does to it.
  Gain::State start(FromInputs& G) {
    Gain::State x = Gain::State::Zero();
    const auto first = played_.behind_event(noisy(0), record_.first_step);
    for (std::size_t i = 0; i < states_; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      x[row] = first[i].a;
      G.row(row) << first[i].d[kMostStates], first[i].d[kMostStates + 1];
    }
    return x;
  }
  Linear at(std::size_t k, const Gain::State& state) {
    Linear l;
    States<D8> x{};
    for (std::size_t i = 0; i < states_; ++i) {
      x[i] = D8(state[static_cast<Eigen::Index>(i)]);
      x[i].d[i] = 1;
    }
    const auto u = noisy(k);
    played_.evaluate(x, u);
    const auto y = played_.outputs();
    for (int o = 0; o < kOutputs; ++o) {
      const auto& value = y[static_cast<std::size_t>(o)];
      l.y[o] = value.a;
      for (std::size_t i = 0; i < kMostStates; ++i) l.C(o, static_cast<Eigen::Index>(i)) = value.d[i];
      for (int i = 0; i < kInputs; ++i) l.D(o, i) = value.d[kMostStates + static_cast<std::size_t>(i)];
    }
    if (k + 1 >= record_.samples()) return l;
    const auto slope = played_.slope();
    const auto v = noisy(k + 1);
    if (record_.leaps[k]) leap(x, slope, v, l);
    played_.step(x, slope, u, v, record_.step);
    for (std::size_t i = 0; i < states_; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      l.next[row] = x[i].a;
      for (std::size_t j = 0; j < kMostStates; ++j) l.F(row, static_cast<Eigen::Index>(j)) = x[i].d[j];
      for (int j = 0; j < kInputs; ++j) l.G(row, j) = x[i].d[kMostStates + static_cast<std::size_t>(j)];
    }
    return l;
  }

 private:
  /// The sample's voltage with its noise as two directions. Both ends of a step have them, for half of what a
  /// sample's noise does happens on the way to it and half on the way from it.
  [[nodiscard]] Inputs<D8> noisy(std::size_t k) const {
    auto u = played<D8>(record_, k);
    for (std::size_t i = 0; i < kInputs; ++i) u[i].d[kMostStates + i] = 1;
    return u;
  }
  /// The voltage leaps anywhere between two samples: of a uniform instant, standard deviation of the state.
  void leap(const States<D8>& x, const States<D8>& before, const Inputs<D8>& v, Linear& l) {
    played_.evaluate(x, v);
    const auto after = played_.slope();
    for (std::size_t i = 0; i < states_; ++i)
      l.leap[static_cast<Eigen::Index>(i)] = record_.step * (after[i].a - before[i].a) / std::sqrt(12.0);
  }

  const NoisyRecord& record_;
  std::size_t states_;
  Played<D8> played_;
};

/// Variances of the compared outputs' own noise.
Eigen::Matrix<double, kOutputs, 1> variances(const MeasurementNoise& noise, double Ifd) {
  Eigen::Matrix<double, kOutputs, 1> v;
  v << noise.phasor(), noise.phasor(), noise.speed(), noise.field(Ifd);
  return v.cwiseAbs2();
}

}  // namespace

Gains gains_about(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
                  const std::array<double, kSteady>& steady) {
  Gains gains;
  gains.at.resize(record.samples());
  Linearised linearised(machine, record, p, steady);
  const double input = record.noise.phasor() * record.noise.phasor();
  FromInputs G = FromInputs::Zero();
  Gain::State x = linearised.start(G);
  StateMatrix P = input * G * G.transpose();
  for (std::size_t k = 0; k < record.samples(); ++k) {
    const Linear l = linearised.at(k, x);
    OutputMatrix S = l.C * P * l.C.transpose() + input * l.D * l.D.transpose();
    S.diagonal() += variances(record.noise, l.y[kIfd]);
    Eigen::Matrix<double, kOutputs, 1> e;
    for (int o = 0; o < kOutputs; ++o) e[o] = record.out[k][static_cast<std::size_t>(o)] - l.y[o];
    if (record.outputs < kOutputs) {  // as if measured without any precision
      S.row(kIfd).setZero();
      S.col(kIfd).setZero();
      S(kIfd, kIfd) = 1;
      e[kIfd] = 0;
    }
    const Eigen::LLT<OutputMatrix> factor(S);
    Gain& gain = gains.at[k];
    gain.whitening = factor.matrixL().solve(OutputMatrix::Identity());
    gain.onto_states =
        factor.solve((l.F * P * l.C.transpose() + input * l.G * l.D.transpose()).transpose()).transpose();
    if (record.outputs < kOutputs) gain.onto_states.col(kIfd).setZero();
    gains.log_determinant -= 2 * gain.whitening.diagonal().array().log().sum();
    gains.squares += (gain.whitening * e).squaredNorm();
    P = l.F * P * l.F.transpose() + input * l.G * l.G.transpose() + l.leap * l.leap.transpose() -
        gain.onto_states * S * gain.onto_states.transpose();
    P = (0.5 * (P + P.transpose())).eval();
    x = l.next + gain.onto_states * e;
  }
  return gains;
}

std::size_t innovation_count(const NoisyRecord& record) {
  const auto outputs = static_cast<std::size_t>(record.outputs);
  return record.samples() * outputs + kSteady + (record.outputs == kOutputs ? 1 : 0);
}

template <class T>
void innovations(const Effect& machine, const NoisyRecord& r, const Gains& gains, const std::vector<T>& p,
                 const std::array<T, kSteady>& steady, T* out) {
  Played<T> m(machine, r.conventions, p, steady);
  // Means before the event are as noisy as one sample over the root of their number.
  const double mean = std::sqrt(r.before) / r.noise.phasor();
  *out++ = T(mean) * (T(r.P0) - steady[kP0]);
  *out++ = T(mean) * (T(r.Q0) - steady[kQ0]);
  *out++ = T(mean) * (T(r.V0) - steady[kV0]);
  *out++ = T(mean) * (T(0.0) - steady[kTheta0]);
  if (r.outputs == kOutputs) *out++ = T(std::sqrt(r.before) / r.noise.field(r.Ifd0)) * (T(r.Ifd0) - m.Ifd0());
  const std::size_t states = machine.states.size();
  States<T> x = m.behind_event(played<T>(r, 0), r.first_step);
  for (std::size_t k = 0; k < r.samples(); ++k) {
    const auto u = played<T>(r, k);
    m.evaluate(x, u);
    const auto y = m.outputs();
    std::array<T, kOutputs> e{};
    for (std::size_t o = 0; o < static_cast<std::size_t>(r.outputs); ++o) e[o] = T(r.out[k][o]) - y[o];
    const Gain& gain = gains.at[k];
    for (int o = 0; o < r.outputs; ++o) {
      T white(0.0);
      for (int i = 0; i <= o; ++i) white = white + T(gain.whitening(o, i)) * e[static_cast<std::size_t>(i)];
      *out++ = white;
    }
    if (k + 1 == r.samples()) break;
    m.step(x, m.slope(), u, played<T>(r, k + 1), r.step);
    for (std::size_t i = 0; i < states; ++i)
      for (int o = 0; o < r.outputs; ++o)
        x[i] = x[i] + T(gain.onto_states(static_cast<Eigen::Index>(i), o)) * e[static_cast<std::size_t>(o)];
  }
}

template void innovations(const Effect&, const NoisyRecord&, const Gains&, const std::vector<double>&,
                          const std::array<double, kSteady>&, double*);
template void innovations(const Effect&, const NoisyRecord&, const Gains&, const std::vector<D8>&,
                          const std::array<D8, kSteady>&, D8*);

}  // namespace swingbank::sim::direct
