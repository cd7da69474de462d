#include "sim/direct/detail/innovations.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <map>

namespace swingbank::sim::direct {
namespace {

using OutputMatrix = Eigen::Matrix<double, kOutputs, kOutputs>;
/// States of the machine and noise of the played-in voltage, which is constant between two samples.
constexpr int kExtended = kSensitivities;
constexpr int kFlowing = static_cast<int>(kMostFlowing);
using ExtendedVector = Eigen::Matrix<double, kExtended, 1>;
using ExtendedMatrix = Eigen::Matrix<double, kExtended, kExtended, Eigen::RowMajor>;
using OutputRows = Eigen::Matrix<double, kOutputs, kExtended, Eigen::RowMajor>;
using StateVector = Eigen::Matrix<double, kFlowing, 1>;
using StateMatrix = Eigen::Matrix<double, kFlowing, kFlowing, Eigen::RowMajor>;

/// Derivatives of the machine's equations at one time with respect to the extended states.
struct ExtendedDerivatives {
  ExtendedMatrix A = ExtendedMatrix::Zero();  ///< of dx/dt; zero for the noise
  OutputRows C;                               ///< of the outputs y
  OutputVector y;
  States<double> derivative;  ///< dx/dt
};

/// Linear equations of a sample about the filter's state: y = C z + v and z' = F z, with the extended states
/// z and the noise v of the outputs. z' at the next sample has a new noise of the voltage.
struct Linear {
  ExtendedMatrix F;
  OutputRows C;
  OutputVector y;
  States<double> next = {};
  /// Effect of half of the noise on the states: the part of the interval before the sample.
  Eigen::Matrix<double, kFlowing, kInputs> half;
};

double input_variance(const NoisyRecord& record) { return record.noise.phasor() * record.noise.phasor(); }

class Linearised {
 public:
  Linearised(const Effect& machine, const NoisyRecord& record, const std::vector<double>& p,
             const std::array<double, kSteady>& steady)
      : record_(record),
        plain_(machine, record.conventions, p, steady),
        dual_(machine, record.conventions, {p.begin(), p.end()},
              {steady[kP0], steady[kQ0], steady[kV0], steady[kTheta0]}) {
    dual_.differentiate(0, static_cast<int>(machine.states.size()), kFlowing);
  }

  /// Returns the state at the first sample and its covariance.
  States<double> start(StateMatrix& P) {
    // The voltage at the event is extrapolated from two samples, so that its noise exceeds that of one
    // sample.
    constexpr double kExtrapolated = 1.5 * 1.5 + 0.5 * 0.5;
    States<double> x = plain_.start();
    const Segment s = first_segment(record_);
    const auto G = extend(x, derivatives(x, s.begin), s).topRightCorner<kFlowing, kInputs>().eval();
    add(x, record_.at_first);
    P = kExtrapolated * input_variance(record_) * G * G.transpose();
    open(plain_.start(), record_.in[0], record_.at_event, kUnsure * record_.first_step, P);
    return x;
  }
  /// Computes the equations of sample k.
  void at(std::size_t k, const States<double>& x, Linear& l) {
    const ExtendedDerivatives here = derivatives(x, record_.in[k]);
    l.y = here.y;
    l.C = here.C;
    l.F.setZero();
    if (k + 1 >= record_.samples()) return;
    l.next = x;
    const Segments between = segments_behind(record_, k);
    l.F = extend(l.next, here, between.part[0]);
    if (between.count == 2) {
      l.F =
          extend(l.next, derivatives(l.next, between.part[1].begin), between.part[1]).lazyProduct(l.F).eval();
      if (const auto leap = record_.behind_leap.find(k); leap != record_.behind_leap.end())
        add(l.next, leap->second);
    }
    // A sample's noise acts half in the interval before the sample and half in the interval after it. The
    // state excludes the first half, which therefore enters y.
    l.half = 0.5 * l.F.topRightCorner<kFlowing, kInputs>();
    l.C.rightCols<kInputs>() += l.C.leftCols<kFlowing>() * l.half;
    l.F.topRightCorner<kFlowing, kInputs>() = l.F.topLeftCorner<kFlowing, kFlowing>() * l.half + l.half;
  }
  /// Returns the covariance of the state behind a voltage step at an unknown time between sample k and the
  /// next. A uniform distribution of this time has the variance T^2/12, T being the sampling interval. The
  /// extrapolated voltages on both sides are uncertain as well.
  StateMatrix unsure_step(std::size_t k, const States<double>& x) {
    const Interval& i = record_.behind[k];
    StateMatrix covariance = StateMatrix::Zero();
    open(x, i.before, i.after, record_.step / std::sqrt(12.0), covariance);
    open(x, i.before, record_.in[k], kUnsure * record_.step / 2, covariance);
    open(x, i.after, record_.in[k + 1], kUnsure * record_.step / 2, covariance);
    return covariance;
  }

 private:
  /// Relative uncertainty of the difference between an extrapolated voltage and the adjacent sample.
  static constexpr double kUnsure = 0.25;

  ExtendedDerivatives derivatives(const States<double>& x, const Inputs& u) {
    dual_.evaluate_at(x, u);
    const auto y = dual_.outputs();
    const auto f = dual_.derivative();
    ExtendedDerivatives s;
    for (int o = 0; o < kOutputs; ++o) {
      s.y[o] = y[static_cast<std::size_t>(o)].a;
      s.C.row(o) = gradient(y[static_cast<std::size_t>(o)]);
    }
    if (record_.outputs < kOutputs) s.C.row(kIfd).setZero();
    for (int i = 0; i < kFlowing; ++i) {
      s.derivative[static_cast<std::size_t>(i)] = f[static_cast<std::size_t>(i)].a;
      s.A.row(i) = gradient(f[static_cast<std::size_t>(i)]);
    }
    return s;
  }
  /// Integrates x over a segment and returns the transition matrix of the extended states. The linear
  /// equations keep the derivatives of the segment's beginning; their transition matrix is the series of the
  /// fourth-order method.
  ExtendedMatrix extend(States<double>& x, const ExtendedDerivatives& s, const Segment& over) {
    const ExtendedMatrix hA = over.length * s.A, one = ExtendedMatrix::Identity();
    ExtendedMatrix F = one + hA / 4;
    for (int order = 3; order > 0; --order) F = (one + hA.lazyProduct(F) / order).eval();
    plain_.integrate(x, s.derivative, over);
    return F;
  }
  /// Adds the covariance of the state if it is unknown whether the voltage was u or v during `h` [s].
  void open(const States<double>& x, const Inputs& u, const Inputs& v, double h, StateMatrix& covariance) {
    const auto a = plain_.derivative_at(x, u), b = plain_.derivative_at(x, v);
    StateVector moved;
    for (int i = 0; i < kFlowing; ++i)
      moved[i] = h * (a[static_cast<std::size_t>(i)] - b[static_cast<std::size_t>(i)]);
    covariance += moved * moved.transpose();
  }

  const NoisyRecord& record_;
  Played<double> plain_;
  Played<D8> dual_;  ///< derivatives with respect to the states and the voltage
};

/// Returns the variances of the noise of the outputs at field current Ifd. That of an Ifd without record does
/// not matter.
OutputVector variances(const NoisyRecord& record, double Ifd) {
  const MeasurementNoise& noise = record.noise;
  OutputVector v;
  v << noise.phasor(), noise.phasor(), noise.speed(), record.outputs < kOutputs ? 1 : noise.field(Ifd);
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

Correction correction(const StateVector& x) {
  Correction c;
  std::ranges::copy(x, c.begin());
  return c;
}

/// Returns the record without its most probable noise, by a backward pass (disturbance smoother, de Jong).
/// `unsure`: covariances of the states behind voltage steps.
NoisyRecord without_noise(const NoisyRecord& record, const std::vector<Step>& steps,
                          const std::vector<Gain>& gains, const StateMatrix& P0,
                          const std::map<std::size_t, StateMatrix>& unsure) {
  NoisyRecord likely = record;
  ExtendedVector back = ExtendedVector::Zero();
  Eigen::Matrix<double, kInputs, 1> noise = Eigen::Matrix<double, kInputs, 1>::Zero();
  for (std::size_t k = steps.size(); k-- > 0;) {
    const auto& [l, weighed] = steps[k];
    if (const auto step = unsure.find(k); step != unsure.end())
      likely.behind_leap[k] = correction(step->second * back.head<kFlowing>());
    const OutputVector own = weighed - gains[k].onto_states.transpose() * back.head<kFlowing>();
    back = (l.C.transpose().lazyProduct(own) + l.F.transpose().lazyProduct(back)).eval();
    noise = -input_variance(record) * back.tail<kInputs>();
    back.tail<kInputs>().setZero();  // the noise of the sample before is another one
    for (int c = 0; c < kInputs; ++c) likely.in[k][static_cast<std::size_t>(c)] -= noise[c];
  }
  likely.at_first = correction(P0 * back.head<kFlowing>() - steps.front().l.half * noise);
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
  std::map<std::size_t, StateMatrix> unsure;
  Linearised linearised(machine, record, p, steady);
  StateMatrix P0;
  States<double> x = linearised.start(P0);
  ExtendedMatrix P = ExtendedMatrix::Zero();  // covariance of the extended states
  P.topLeftCorner<kFlowing, kFlowing>() = P0;
  for (std::size_t k = 0; k < record.samples(); ++k) {
    auto& [l, weighed] = steps[k];
    linearised.at(k, x, l);
    P.rightCols<kInputs>().setZero();
    P.bottomRows<kInputs>().setZero();
    P.diagonal().tail<kInputs>().setConstant(input_variance(record));
    const OutputRows CP = l.C.lazyProduct(P);
    OutputMatrix S = CP.lazyProduct(l.C.transpose());
    S.diagonal() += variances(record, l.y[kIfd]);
    const ExtendedMatrix transposed = l.F.transpose();
    Gain& gain = f.gains[k];
    gain.whitening = S.llt().matrixL().solve(OutputMatrix::Identity());
    const OutputRows white = gain.whitening.lazyProduct(CP.lazyProduct(transposed).eval());
    gain.onto_states = white.leftCols<kFlowing>().transpose() * gain.whitening;
    const OutputVector e = innovation(record, k, l);
    f.white[k] = gain.whitening * e;
    f.log_determinant -= 2 * gain.whitening.diagonal().array().log().sum();
    weighed = gain.whitening.transpose() * f.white[k];
    P = (l.F.lazyProduct(P).eval().lazyProduct(transposed) - white.transpose().lazyProduct(white)).eval();
    if (k < record.behind.size() && record.behind[k].leaps)
      P.topLeftCorner<kFlowing, kFlowing>() += unsure[k] = linearised.unsure_step(k, x);
    x = l.next;
    add(x, gain.onto_states * e);
  }
  f.likely = without_noise(record, steps, f.gains, P0, unsure);
  return f;
}

}  // namespace swingbank::sim::direct
