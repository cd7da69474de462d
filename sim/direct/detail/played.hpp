#pragma once
// Machine whose terminal voltage is played in from a noisy record, in the synchronous frame.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <vector>

#include "sim/core/scalar.hpp"
#include "sim/direct/detail/noisy_record.hpp"
#include "sim/direct/detail/playback_machine.hpp"

namespace swingbank::sim::direct {

/// Operating point before the event. It is estimated, because means of noisy samples are inexact.
enum Steady { kP0, kQ0, kV0, kTheta0, kSteady };

template <class T>
using States = std::array<T, kMostFlowing>;
template <class T>
using Voltage = std::array<T, kInputs>;

/// Returns the derivatives of a dual number as a row.
inline auto gradient(const D8& x) {
  Eigen::Matrix<double, 1, kSensitivities> row;
  x.d.store(row.data());
  return row;
}

/// Adds a correction of the states.
inline void add(States<double>& x, const Correction& by) {
  for (std::size_t i = 0; i < kMostFlowing; ++i) x[i] += by[i];
}
inline void add(States<double>& x, const Eigen::Matrix<double, kMostFlowing, 1>& by) {
  for (std::size_t i = 0; i < kMostFlowing; ++i) x[i] += by[static_cast<Eigen::Index>(i)];
}

/// Part of a sampling interval in which the played-in voltage is smooth.
struct Segment {
  Inputs begin = {}, middle = {}, end = {};  ///< voltage
  double length = 0;                         ///< [s]
};
/// Segments of an interval: two if it contains a voltage step, else one.
struct Segments {
  std::array<Segment, 2> part = {};
  int count = 1;
};

/// Returns the segment from the event to the first sample after it.
Segment first_segment(const NoisyRecord& record);
/// Returns the segments between sample k and the next.
Segments segments_behind(const NoisyRecord& record, std::size_t k);

template <class T>
class Played {
 public:
  Played(const Effect& machine, const Conventions& conventions, const std::vector<T>& p,
         const std::array<T, kSteady>& steady)
      : m_(machine, conventions, p, steady[kV0], steady[kP0] / steady[kV0],
           T(0.0) - steady[kQ0] / steady[kV0]) {
    start_ = m_.x;
    start_[0] = start_[0] + steady[kTheta0];
    evaluate(start_, {steady[kV0], steady[kTheta0]});
    Ifd0_ = m_.s.Ifd;
  }
  [[nodiscard]] const States<T>& start() const { return start_; }
  [[nodiscard]] const T& Ifd0() const { return Ifd0_; }  ///< field current of the steady state [pu]
  /// Computes the algebraic equations at states x and voltage u.
  void evaluate(const States<T>& x, const Voltage<T>& u) {
    m_.x = x;
    m_.x[0] = x[0] - u[kTheta];
    m_.evaluate(u[kV]);
  }
  /// Differentiates with respect to the states: the derivatives with respect to state i are number
  /// `first` + i of each dual number, where it exists. Those with respect to the voltage and its angle follow
  /// from `inputs` on. Afterwards, use evaluate_at().
  void differentiate(int first, int states, int inputs) {
    const auto set = [](T& value, int at, double derivative) {
      if (at >= 0 && at < kSensitivities) value.d.set(at, derivative);
    };
    m_.x.fill(T(0.0));
    V_ = T(0.0);
    for (int i = 0; i < states; ++i) set(m_.x[static_cast<std::size_t>(i)], first + i, 1);
    set(V_, inputs + kV, 1);
    set(m_.x[0], inputs + kTheta, -1);
  }
  /// Computes the algebraic equations at states x and voltage u, after differentiate().
  void evaluate_at(const States<double>& x, const Inputs& u) {
    for (std::size_t i = 0; i < kMostFlowing; ++i) m_.x[i].a = x[i];
    m_.x[0].a -= u[kTheta];
    V_.a = u[kV];
    m_.evaluate(V_);
  }
  /// Returns the compared signals; call after evaluate() or evaluate_at().
  [[nodiscard]] std::array<T, kOutputs> outputs() const {
    const auto& s = m_.s;
    return {s.Vr * s.Ir, T(0.0) - s.Vr * s.Ii, s.speed, s.Ifd};
  }
  /// Returns the derivatives of the states; call after evaluate() or evaluate_at().
  States<T> derivative() {
    m_.derive();
    return m_.dx;
  }
  States<T> derivative_at(const States<T>& x, const Voltage<T>& u) {
    evaluate(x, u);
    return derivative();
  }
  /// Integrates over a segment; `first`: derivative at its beginning.
  void integrate(States<T>& x, const States<T>& first, const Segment& s) {
    runge_kutta(x, first, s.length, [&](int stage, const States<T>& y) {
      return derivative_at(y, stage == 3 ? s.end : s.middle);
    });
  }

 private:
  PlaybackMachine<T> m_;
  T V_ = T(0.0);
  States<T> start_{};
  T Ifd0_;
};

}  // namespace swingbank::sim::direct
