#include "sim/direct/detail/innovations.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace swingbank::sim::direct {
namespace {

using OutputMatrix = Eigen::Matrix<double, kOutputs, kOutputs>;
using StateVector = Eigen::Matrix<double, kMostFlowing, 1>;
using StateMatrix = Eigen::Matrix<double, kMostFlowing, kMostFlowing>;
using FromInputs = Eigen::Matrix<double, kMostFlowing, kInputs>;

/// Derivatives of the machine's equations at one time: of dx/dt and of the outputs y, with respect to the
/// states and the played-in voltage.
struct InputDerivatives {
  StateMatrix A;
  FromInputs B;
  Eigen::Matrix<double, kOutputs, kMostFlowing> C;
  Eigen::Matrix<double, kOutputs, kInputs> D;
  OutputVector y;
  States<double> derivative;  ///< dx/dt
};

/// Linear equations of a sample about the filter's state: y = C x + D n + v and, for the next
/// sample, F x + G n. n: noise of the played-in voltage; v: noise of the outputs.
struct Linear {
  StateMatrix F = StateMatrix::Zero();
  FromInputs G = FromInputs::Zero();
  Eigen::Matrix<double, kOutputs, kMostFlowing> C;
  Eigen::Matrix<double, kOutputs, kInputs> D;
  OutputVector y;
  States<double> next = {};
  FromInputs half = FromInputs::Zero();      ///< effect of a sample's noise in the interval before it
  StateMatrix unsure = StateMatrix::Zero();  ///< covariance due to a voltage step before the next sample
};

class Linearised {
 public:
  Linearised(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
             const std::array<double, kSteady>& steady)
      : record_(record),
        states_(machine.states.size()),
        plain_(machine, record.conventions, p, steady),
        dual_(machine, record.conventions, {p.begin(), p.end()},
              {steady[kP0], steady[kQ0], steady[kV0], steady[kTheta0]}) {}

  /// Returns the state at the first sample and its covariance.
  States<double> start(StateMatrix& P) {
    // The voltage at the event is extrapolated from two samples, so that its noise exceeds that of one
    // sample.
    constexpr double kExtrapolated = 1.5 * 1.5 + 0.5 * 0.5;
    Linear l;
    States<double> x = plain_.start();
    const Segment s = first_segment(record_);
    extend(l, x, derivatives(x, s.begin), s);
    add(x, record_.at_first);
    const double input = kExtrapolated * std::pow(record_.noise.phasor(), 2);
    P = input * l.G * l.G.transpose();
    open(plain_.start(), record_.in[0], record_.at_event, kUnsure * record_.first_step, P);
    return x;
  }
  /// Computes the equations of sample k into a default-initialised `l`.
  void at(std::size_t k, const States<double>& x, Linear& l) {
    const InputDerivatives here = derivatives(x, record_.in[k]);
    l.y = here.y;
    l.C = here.C;
    l.D = here.D;
    if (k + 1 >= record_.samples()) return;
    l.next = x;
    const Segments between = segments_behind(record_, k);
    extend(l, l.next, here, between.part[0]);
    if (between.count == 2) {
      extend(l, l.next, derivatives(l.next, between.part[1].begin), between.part[1]);
      if (const auto leap = record_.behind_leap.find(k); leap != record_.behind_leap.end())
        add(l.next, leap->second);
      unsure_step(x, k, l.unsure);
    }
    halve(l);
  }

 private:
  /// Relative uncertainty of the difference between an extrapolated voltage and the adjacent sample.
  static constexpr double kUnsure = 0.25;

  InputDerivatives derivatives(const States<double>& x, const Inputs& u) {
    States<D8> dual{};
    for (std::size_t i = 0; i < states_; ++i) {
      dual[i].a = x[i];
      dual[i].d[i] = 1;
    }
    Voltage<D8> v = {D8(u[kV]), D8(u[kTheta])};
    for (std::size_t i = 0; i < kInputs; ++i) v[i].d[kMostFlowing + i] = 1;
    dual_.evaluate(dual, v);
    const auto y = dual_.outputs();
    const auto f = dual_.derivative();
    InputDerivatives s;
    const auto split = [](const D8& value, auto states, auto inputs) {
      for (std::size_t i = 0; i < kMostFlowing; ++i) states[static_cast<Eigen::Index>(i)] = value.d[i];
      for (std::size_t i = 0; i < kInputs; ++i)
        inputs[static_cast<Eigen::Index>(i)] = value.d[kMostFlowing + i];
    };
    for (Eigen::Index o = 0; o < kOutputs; ++o) {
      s.y[o] = y[static_cast<std::size_t>(o)].a;
      split(y[static_cast<std::size_t>(o)], s.C.row(o), s.D.row(o));
    }
    for (std::size_t i = 0; i < kMostFlowing; ++i) {
      s.derivative[i] = f[i].a;
      split(f[i], s.A.row(static_cast<Eigen::Index>(i)), s.B.row(static_cast<Eigen::Index>(i)));
    }
    return s;
  }
  /// Integrates x over a segment, and extends F and G by it. The linear equations keep the derivatives of the
  /// segment's beginning; their transition matrix is the series of the fourth-order method.
  void extend(Linear& l, States<double>& x, const InputDerivatives& s, const Segment& over) {
    const StateMatrix hA = over.length * s.A, square = hA * hA, cube = square * hA;
    const StateMatrix mean = StateMatrix::Identity() + hA / 2 + square / 6 + cube / 24;
    const StateMatrix F = StateMatrix::Identity() + hA * mean;
    const FromInputs G = over.length * (mean * s.B);
    l.G = (F * l.G + G).eval();
    l.F = l.F.isZero(0) ? F : (F * l.F).eval();
    plain_.integrate(x, s.derivative, over);
  }
  /// A sample's noise acts half in the interval before the sample and half in the interval after it. The
  /// state excludes the first half, which therefore enters y through D.
  static void halve(Linear& l) {
    l.half = 0.5 * l.G;
    l.D += 0.5 * l.C * l.G;
    l.G = (0.5 * (l.F * l.G + l.G)).eval();
  }
  /// Adds the covariance of the state if it is unknown whether the voltage was u or v during `h` [s].
  void open(const States<double>& x, const Inputs& u, const Inputs& v, double h, StateMatrix& covariance) {
    const auto a = plain_.derivative_at(x, u), b = plain_.derivative_at(x, v);
    StateVector moved;
    for (std::size_t i = 0; i < kMostFlowing; ++i) moved[static_cast<Eigen::Index>(i)] = h * (a[i] - b[i]);
    covariance += moved * moved.transpose();
  }
  /// Adds the covariance of a voltage step at an unknown time between two samples. A uniform distribution of
  /// this time has the variance T^2/12, T being the sampling interval. The extrapolated voltages on both
  /// sides are uncertain as well.
  void unsure_step(const States<double>& x, std::size_t k, StateMatrix& covariance) {
    const Interval& i = record_.behind[k];
    open(x, i.before, i.after, record_.step / std::sqrt(12.0), covariance);
    open(x, i.before, record_.in[k], kUnsure * record_.step / 2, covariance);
    open(x, i.after, record_.in[k + 1], kUnsure * record_.step / 2, covariance);
  }

  const NoisyRecord& record_;
  std::size_t states_;
  Played<double> plain_;
  Played<D8> dual_;  ///< derivatives with respect to the states and the voltage
};

/// Returns the variances of the noise of the compared outputs.
OutputVector variances(const MeasurementNoise& noise, double Ifd) {
  OutputVector v;
  v << noise.phasor(), noise.phasor(), noise.speed(), noise.field(Ifd);
  return v.cwiseAbs2();
}

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
  if (record.outputs < kOutputs) {  // Ifd is not recorded: as if measured with infinite variance
    S.row(kIfd).setZero();
    S.col(kIfd).setZero();
    S(kIfd, kIfd) = 1;
  }
  return S;
}

Correction correction(const StateVector& x) {
  Correction c;
  std::ranges::copy(x, c.begin());
  return c;
}

/// Returns the record without its most probable noise, by a backward pass (disturbance smoother, de Jong).
NoisyRecord without_noise(const NoisyRecord& record, const std::vector<Step>& steps,
                          const std::vector<Gain>& gains, const StateMatrix& P0) {
  NoisyRecord likely = record;
  const double input = record.noise.phasor() * record.noise.phasor();
  StateVector back = StateVector::Zero();
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
  States<double> x = linearised.start(P0);
  StateMatrix P = P0;
  for (std::size_t k = 0; k < record.samples(); ++k) {
    auto& [l, weighed] = steps[k];
    linearised.at(k, x, l);
    const OutputVector e = innovation(record, k, l);
    const OutputMatrix S = covariance(record, l, P);
    const Eigen::LLT<OutputMatrix> factor(S);
    Gain& gain = f.gains[k];
    gain.whitening = factor.matrixL().solve(OutputMatrix::Identity());
    gain.onto_states =
        factor.solve((l.F * P * l.C.transpose() + input * l.G * l.D.transpose()).transpose()).transpose();
    if (record.outputs < kOutputs) gain.onto_states.col(kIfd).setZero();
    f.white[k] = gain.whitening * e;
    f.log_determinant -= 2 * gain.whitening.diagonal().array().log().sum();
    weighed = gain.whitening.transpose() * f.white[k];
    P = l.F * P * l.F.transpose() + input * l.G * l.G.transpose() + l.unsure -
        gain.onto_states * S * gain.onto_states.transpose();
    P = (0.5 * (P + P.transpose())).eval();
    x = l.next;
    add(x, gain.onto_states * e);
  }
  f.likely = without_noise(record, steps, f.gains, P0);
  return f;
}

}  // namespace swingbank::sim::direct
