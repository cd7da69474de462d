// Sensitivities of the whitened innovations. The equations are linearised at every sample by dual numbers,
// and their variational equation is integrated between the samples with the same fourth-order method.
#include <cmath>
#include <utility>

#include "sim/direct/detail/innovations.hpp"

namespace swingbank::sim::direct {
namespace {

using Eigen::Index;

/// Derivatives of dx/dt and of the outputs y at one time, with respect to the states and the unknowns.
/// `Columns`: number of unknowns and states, rounded up to a multiple of kSensitivities. E and Y are zero in
/// the columns behind those of the unknowns.
template <int Columns>
struct Derivatives {
  using States = Eigen::Matrix<double, kMostFlowing, Columns, Eigen::RowMajor>;
  using Outputs = Eigen::Matrix<double, kOutputs, Columns, Eigen::RowMajor>;

  Eigen::Matrix<double, kMostFlowing, kMostFlowing> A;  ///< of dx/dt with respect to the states
  States E;                                             ///< of dx/dt with respect to the unknowns
  Eigen::Matrix<double, kOutputs, kMostFlowing> C;      ///< of y with respect to the states
  Outputs Y;                                            ///< of y with respect to the unknowns
  std::array<double, kOutputs> y;
  direct::States<double> derivative;  ///< dx/dt
};

/// Returns the sensitivities of the states at the end of a segment. a, b: derivatives at its beginning and
/// end.
template <class Derivatives>
typename Derivatives::States integrated(const typename Derivatives::States& S, const Derivatives& a,
                                        const Derivatives& b, double h) {
  using States = typename Derivatives::States;
  const auto A = ((a.A + b.A) / 2).eval();
  const States E = (a.E + b.E) / 2;
  const States first = a.A.lazyProduct(S) + a.E;
  const States second = A.lazyProduct((S + h / 2 * first).eval()) + E;
  const States third = A.lazyProduct((S + h / 2 * second).eval()) + E;
  const States fourth = b.A.lazyProduct((S + h * third).eval()) + b.E;
  return S + h / 6 * (first + 2 * (second + third) + fourth);
}

/// Machine in dual numbers. Columns of derivatives: the unknowns, then the states. Each dual number has
/// kSensitivities of them.
template <int Columns>
class DualMachine {
 public:
  using Derivatives = direct::Derivatives<Columns>;
  using ByUnknowns = typename Derivatives::States;

  DualMachine(const Effect& machine, const Conventions& conventions, const std::vector<double>& p,
              const std::array<double, kSteady>& steady, std::span<const ScaledParameter> parameters)
      : unknowns_(static_cast<int>(parameters.size()) + kSteady),
        states_(static_cast<int>(machine.states.size())) {
    for (int first = 0; first < Columns; first += kSensitivities) {
      std::vector<D8> dual(p.begin(), p.end());
      std::array<D8, kSteady> point;
      std::ranges::copy(steady, point.begin());
      for (int lane = 0; lane < kSensitivities; ++lane) {
        const int column = first + lane, beyond = column - static_cast<int>(parameters.size());
        if (beyond < 0) {
          const ScaledParameter& by = parameters[static_cast<std::size_t>(column)];
          dual[static_cast<std::size_t>(by.index)].d.set(lane, by.scale);
        } else if (beyond < kSteady) {
          point[static_cast<std::size_t>(beyond)].d.set(lane, 1);
        }
      }
      parts_.emplace_back(machine, conventions, dual, point)
          .differentiate(unknowns_ - first, states_, kSensitivities);
    }
  }
  /// Returns the sensitivities of the steady state.
  [[nodiscard]] ByUnknowns start() const {
    ByUnknowns S;
    for (int part = 0; part < kDuals; ++part)
      for (std::size_t i = 0; i < kMostFlowing; ++i)
        block(S, static_cast<Index>(i), part) = gradient(parts_[static_cast<std::size_t>(part)].start()[i]);
    return S;
  }
  /// Returns the sensitivities of the field current of the steady state.
  [[nodiscard]] Eigen::Matrix<double, 1, Columns> Ifd0() const {
    Eigen::Matrix<double, 1, Columns> by;
    for (int part = 0; part < kDuals; ++part)
      block(by, 0, part) = gradient(parts_[static_cast<std::size_t>(part)].Ifd0());
    return by;
  }
  void derivatives(const States<double>& x, const Inputs& u, Derivatives& s) {
    for (int part = 0; part < kDuals; ++part) {
      Played<D8>& machine = parts_[static_cast<std::size_t>(part)];
      machine.evaluate_at(x, u);
      const auto y = machine.outputs();
      const auto f = machine.derivative();
      for (std::size_t o = 0; o < kOutputs; ++o) {
        s.y[o] = y[o].a;
        block(s.Y, static_cast<Index>(o), part) = gradient(y[o]);
      }
      for (std::size_t i = 0; i < kMostFlowing; ++i) {
        s.derivative[i] = f[i].a;
        block(s.E, static_cast<Index>(i), part) = gradient(f[i]);
      }
    }
    split(s.Y, s.C);
    split(s.E, s.A);
  }

 private:
  static constexpr int kDuals = Columns / kSensitivities;

  template <class Matrix>
  static auto block(Matrix& m, Index row, int part) {
    return m.template block<1, kSensitivities>(row, part * kSensitivities);
  }
  /// Moves the derivatives with respect to the states out of the columns of the unknowns.
  template <class All, class ByStates>
  void split(All& all, ByStates& by_states) const {
    by_states.setZero();
    for (Index j = 0; j < states_; ++j)
      for (Index i = 0; i < all.rows(); ++i) by_states(i, j) = std::exchange(all(i, unknowns_ + j), 0.0);
  }

  int unknowns_, states_;
  std::vector<Played<D8>> parts_;
};

/// Weights of the means before the event, in the order P, Q, V, theta, Ifd. The noise of a mean equals the
/// noise of one sample, divided by the square root of the number of samples.
std::vector<double> steady_weights(const NoisyRecord& r) {
  const double one = std::sqrt(r.before) / r.noise.phasor();
  std::vector<double> weights(kSteady, one);
  if (r.outputs == kOutputs) weights.push_back(std::sqrt(r.before) / r.noise.field(r.Ifd0));
  return weights;
}

/// Returns the whitened differences between the means before the event and the operating point.
Eigen::VectorXd steady_residuals(const NoisyRecord& r, const std::vector<double>& weights,
                                 const std::array<double, kSteady>& steady, double Ifd0) {
  const double differences[] = {r.P0 - steady[kP0], r.Q0 - steady[kQ0], r.V0 - steady[kV0],
                                0 - steady[kTheta0], r.Ifd0 - Ifd0};
  Eigen::VectorXd value(static_cast<Index>(weights.size()));
  for (Index i = 0; i < value.size(); ++i) value[i] = weights[static_cast<std::size_t>(i)] * differences[i];
  return value;
}

}  // namespace

Segment first_segment(const NoisyRecord& r) {
  return {r.at_event, between(r.at_event, r.end_of_first, 0.5), r.end_of_first, r.first_step};
}

Segments segments_behind(const NoisyRecord& r, std::size_t k) {
  const Interval& i = r.behind[k];
  const Inputs &u = r.in[k], &v = r.in[k + 1];
  if (!i.leaps) return {{{{u, i.middle, v, r.step}, {}}}, 1};
  return {{{{u, between(u, i.before, 0.5), i.before, r.step / 2},
            {i.after, between(i.after, v, 0.5), v, r.step / 2}}},
          2};
}

std::size_t residual_count(const NoisyRecord& record) {
  return record.samples() * static_cast<std::size_t>(record.outputs) + steady_weights(record).size();
}

namespace {

template <int Columns>
LinearisedResiduals linearise_in(const Effect& machine, const NoisyRecord& record, const Filtered& filtered,
                                 const std::vector<double>& p, const std::array<double, kSteady>& steady,
                                 std::span<const ScaledParameter> parameters) {
  using Dual = DualMachine<Columns>;
  const NoisyRecord& r = filtered.likely;
  Dual dual(machine, r.conventions, p, steady, parameters);
  Played<double> plain(machine, r.conventions, p, steady);
  const auto n = static_cast<Index>(parameters.size()) + kSteady;
  const auto count = static_cast<Index>(residual_count(record));
  LinearisedResiduals l;
  l.unknowns = n;
  l.value.resize(count);
  l.response.resize(r.samples());
  l.columns.resize(count, Columns);
  const std::vector<double> weights = steady_weights(record);
  Index row = static_cast<Index>(weights.size());
  l.value.head(row) = steady_residuals(record, weights, steady, plain.Ifd0());
  l.columns.topRows(row).setZero();
  for (Index i = 0; i < kSteady; ++i) l.columns(i, n - kSteady + i) = -weights[static_cast<std::size_t>(i)];
  if (row > kSteady) l.columns.row(kSteady) = -weights.back() * dual.Ifd0();

  States<double> x = plain.start();
  typename Dual::ByUnknowns S = dual.start();
  // Derivatives at the beginning and the end of the segment.
  std::array<typename Dual::Derivatives, 2> both;
  auto *here = &both[0], *end = &both[1];
  const auto advance = [&](const Segment& s) {
    plain.integrate(x, here->derivative, s);
    dual.derivatives(x, s.end, *end);
    S = integrated(S, *here, *end, s.length);
  };
  const Segment first = first_segment(r);
  dual.derivatives(x, first.begin, *here);
  advance(first);
  add(x, r.at_first);
  dual.derivatives(x, r.in[0], *here);
  for (std::size_t k = 0; k < r.samples(); ++k, row += r.outputs) {
    l.response[k] = here->y;
    const typename Dual::Derivatives::Outputs change = here->C.lazyProduct(S) + here->Y;
    l.columns.middleRows(row, r.outputs) =
        -filtered.gains[k].whitening.topRows(r.outputs).lazyProduct(change);
    l.value.segment(row, r.outputs) = filtered.white[k].head(r.outputs);
    if (k + 1 == r.samples()) break;
    const Segments between = segments_behind(r, k);
    advance(between.part[0]);
    if (between.count == 2) {
      dual.derivatives(x, between.part[1].begin, *here);
      advance(between.part[1]);
      if (const auto leap = r.behind_leap.find(k); leap != r.behind_leap.end()) {
        add(x, leap->second);
        dual.derivatives(x, r.in[k + 1], *end);
      }
    }
    std::swap(here, end);
    S -= filtered.gains[k].onto_states.lazyProduct(change);
  }
  return l;
}

}  // namespace

LinearisedResiduals linearise(const Effect& machine, const NoisyRecord& record, const Filtered& filtered,
                              const std::vector<double>& p, const std::array<double, kSteady>& steady,
                              std::span<const ScaledParameter> parameters) {
  // The number of columns is a constant of each instance, so that their loops have a fixed length.
  const auto columns = parameters.size() + kSteady + machine.states.size();
  const auto with = columns <= 8    ? linearise_in<8>
                    : columns <= 16 ? linearise_in<16>
                    : columns <= 24 ? linearise_in<24>
                                    : linearise_in<32>;
  return with(machine, record, filtered, p, steady, parameters);
}

Eigen::VectorXd residuals(const Effect& machine, const NoisyRecord& record, const Filtered& filtered,
                          const std::vector<std::array<double, kOutputs>>& response,
                          const std::vector<double>& p, const std::array<double, kSteady>& steady) {
  const NoisyRecord& r = filtered.likely;
  Played<double> m(machine, r.conventions, p, steady);
  Eigen::VectorXd value(static_cast<Index>(residual_count(record)));
  const std::vector<double> weights = steady_weights(record);
  Index row = static_cast<Index>(weights.size());
  value.head(row) = steady_residuals(record, weights, steady, m.Ifd0());
  States<double> x = m.start();
  const Segment first = first_segment(r);
  m.integrate(x, m.derivative_at(x, first.begin), first);
  add(x, r.at_first);
  for (std::size_t k = 0; k < r.samples(); ++k, row += r.outputs) {
    m.evaluate(x, r.in[k]);
    const auto y = m.outputs();
    OutputVector e = OutputVector::Zero();
    for (int o = 0; o < r.outputs; ++o)
      e[o] = response[k][static_cast<std::size_t>(o)] - y[static_cast<std::size_t>(o)];
    value.segment(row, r.outputs) = (filtered.white[k] + filtered.gains[k].whitening * e).head(r.outputs);
    if (k + 1 == r.samples()) break;
    const Segments between = segments_behind(r, k);
    m.integrate(x, m.derivative(), between.part[0]);
    if (between.count == 2) {
      m.integrate(x, m.derivative_at(x, between.part[1].begin), between.part[1]);
      if (const auto leap = r.behind_leap.find(k); leap != r.behind_leap.end()) add(x, leap->second);
    }
    add(x, filtered.gains[k].onto_states * e);
  }
  return value;
}

}  // namespace swingbank::sim::direct
