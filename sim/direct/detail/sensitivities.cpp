// Sensitivities of the whitened innovations. The equations are linearised at every sample by dual numbers,
// and their variational equation is integrated between the samples with the same fourth-order method.
#include <cmath>

#include "sim/direct/detail/innovations.hpp"

namespace swingbank::sim::direct {
namespace {

using Eigen::Index;

constexpr Index kColumns = kMostUnknowns;
using ByUnknowns = Eigen::Matrix<double, kMostFlowing, kColumns, Eigen::RowMajor>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using OutputsByUnknowns = Eigen::Matrix<double, kOutputs, kColumns, Eigen::RowMajor>;

/// Derivatives of dx/dt and of the outputs y with respect to the states and the unknowns, at one time.
struct UnknownDerivatives {
  Eigen::Matrix<double, kMostFlowing, kMostFlowing> A = decltype(A)::Zero();
  ByUnknowns E = ByUnknowns::Zero();
  Eigen::Matrix<double, kOutputs, kMostFlowing> C = decltype(C)::Zero();
  OutputsByUnknowns Y = OutputsByUnknowns::Zero();
  std::array<double, kOutputs> y;
};

/// Returns the sensitivities of the states at the end of a segment. a, b: derivatives at its beginning and
/// end.
ByUnknowns integrated(const ByUnknowns& S, const UnknownDerivatives& a, const UnknownDerivatives& b,
                      double h) {
  const auto A = ((a.A + b.A) / 2).eval();
  const ByUnknowns E = (a.E + b.E) / 2;
  const ByUnknowns first = a.A.lazyProduct(S) + a.E;
  const ByUnknowns second = A.lazyProduct((S + h / 2 * first).eval()) + E;
  const ByUnknowns third = A.lazyProduct((S + h / 2 * second).eval()) + E;
  const ByUnknowns fourth = b.A.lazyProduct((S + h * third).eval()) + b.E;
  return S + h / 6 * (first + 2 * (second + third) + fourth);
}

/// Machine in dual numbers. Columns of derivatives: the unknowns, then the states. Each dual number has
/// kSensitivities of them.
class DualMachine {
 public:
  DualMachine(const Effect& machine, const Conventions& conventions, const std::vector<double>& p,
              const std::array<double, kSteady>& steady, std::span<const ScaledParameter> parameters)
      : unknowns_(static_cast<int>(parameters.size()) + kSteady),
        states_(static_cast<int>(machine.states.size())) {
    for (int first = 0; first < unknowns_ + states_; first += kSensitivities) {
      std::vector<D8> dual(p.begin(), p.end());
      std::array<D8, kSteady> point;
      std::ranges::copy(steady, point.begin());
      for (int lane = 0; lane < kSensitivities; ++lane) {
        const int column = first + lane, beyond = column - static_cast<int>(parameters.size());
        const auto d = static_cast<std::size_t>(lane);
        if (beyond < 0) {
          const ScaledParameter& by = parameters[static_cast<std::size_t>(column)];
          dual[static_cast<std::size_t>(by.index)].d[d] = by.scale;
        } else if (beyond < kSteady) {
          point[static_cast<std::size_t>(beyond)].d[d] = 1;
        }
      }
      parts_.emplace_back(machine, conventions, dual, point);
    }
  }
  /// Returns the sensitivities of the steady state.
  [[nodiscard]] ByUnknowns start() const {
    ByUnknowns S = ByUnknowns::Zero();
    for_columns([&](const Played<D8>& part, std::size_t lane, int column) {
      for (Index i = 0; i < states_; ++i) S(i, column) = part.start()[static_cast<std::size_t>(i)].d[lane];
    });
    return S;
  }
  /// Returns the sensitivities of the field current of the steady state.
  [[nodiscard]] Eigen::VectorXd Ifd0() const {
    Eigen::VectorXd by = Eigen::VectorXd::Zero(unknowns_);
    for_columns(
        [&](const Played<D8>& part, std::size_t lane, int column) { by[column] = part.Ifd0().d[lane]; });
    return by;
  }
  void derivatives(const States<double>& x, const Inputs& u, UnknownDerivatives& s) {
    const Voltage<D8> v = {D8(u[kV]), D8(u[kTheta])};
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      const int first = static_cast<int>(part) * kSensitivities;
      States<D8> dual{};
      for (int i = 0; i < states_; ++i) {
        dual[static_cast<std::size_t>(i)].a = x[static_cast<std::size_t>(i)];
        const int lane = unknowns_ + i - first;
        if (lane >= 0 && lane < kSensitivities)
          dual[static_cast<std::size_t>(i)].d[static_cast<std::size_t>(lane)] = 1;
      }
      parts_[part].evaluate(dual, v);
      const auto y = parts_[part].outputs();
      const auto f = parts_[part].derivative();
      for (std::size_t o = 0; o < kOutputs; ++o) s.y[o] = y[o].a;
      const int own = std::clamp(unknowns_ - first, 0, kSensitivities);
      const int all = std::min(unknowns_ + states_ - first, kSensitivities);
      const auto split = [&](const D8& value, auto unknowns, auto states) {
        for (int i = 0; i < own; ++i) unknowns[first + i] = value.d[static_cast<std::size_t>(i)];
        for (int i = own; i < all; ++i) states[first + i - unknowns_] = value.d[static_cast<std::size_t>(i)];
      };
      for (Index o = 0; o < kOutputs; ++o) split(y[static_cast<std::size_t>(o)], s.Y.row(o), s.C.row(o));
      for (Index i = 0; i < states_; ++i) split(f[static_cast<std::size_t>(i)], s.E.row(i), s.A.row(i));
    }
  }

 private:
  template <class Function>
  void for_columns(const Function& of) const {
    for (int column = 0; column < unknowns_; ++column)
      of(parts_[static_cast<std::size_t>(column / kSensitivities)],
         static_cast<std::size_t>(column % kSensitivities), column);
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

LinearisedResiduals linearise(const Effect& machine, const NoisyRecord& record, const Filtered& filtered,
                              const std::vector<double>& p, const std::array<double, kSteady>& steady,
                              std::span<const ScaledParameter> parameters) {
  const NoisyRecord& r = filtered.likely;
  DualMachine dual(machine, r.conventions, p, steady, parameters);
  Played<double> plain(machine, r.conventions, p, steady);
  const auto n = static_cast<Index>(parameters.size()) + kSteady;
  const auto count = static_cast<Index>(residual_count(record));
  LinearisedResiduals l;
  l.value.resize(count);
  l.response.resize(r.samples());
  RowMatrix jacobian = RowMatrix::Zero(count, n);
  const std::vector<double> weights = steady_weights(record);
  Index row = static_cast<Index>(weights.size());
  l.value.head(row) = steady_residuals(record, weights, steady, plain.Ifd0());
  for (Index i = 0; i < kSteady; ++i) jacobian(i, n - kSteady + i) = -weights[static_cast<std::size_t>(i)];
  if (row > kSteady) jacobian.row(kSteady) = -weights.back() * dual.Ifd0();

  States<double> x = plain.start();
  ByUnknowns S = dual.start();
  // Derivatives at the beginning and the end of the segment.
  UnknownDerivatives here, end;
  const auto advance = [&](const Segment& s) {
    plain.integrate(x, plain.derivative_at(x, s.begin), s);
    dual.derivatives(x, s.end, end);
    S = integrated(S, here, end, s.length);
  };
  const Segment first = first_segment(r);
  dual.derivatives(x, first.begin, here);
  advance(first);
  add(x, r.at_first);
  dual.derivatives(x, r.in[0], here);
  for (std::size_t k = 0; k < r.samples(); ++k, row += r.outputs) {
    l.response[k] = here.y;
    const OutputsByUnknowns change = here.C.lazyProduct(S) + here.Y;
    const OutputsByUnknowns white = -filtered.gains[k].whitening.lazyProduct(change);
    jacobian.middleRows(row, r.outputs) = white.topLeftCorner(r.outputs, n);
    l.value.segment(row, r.outputs) = filtered.white[k].head(r.outputs);
    if (k + 1 == r.samples()) break;
    const Segments between = segments_behind(r, k);
    advance(between.part[0]);
    if (between.count == 2) {
      dual.derivatives(x, between.part[1].begin, here);
      advance(between.part[1]);
      if (const auto leap = r.behind_leap.find(k); leap != r.behind_leap.end()) {
        add(x, leap->second);
        dual.derivatives(x, r.in[k + 1], end);
      }
    }
    std::swap(here, end);
    S -= filtered.gains[k].onto_states.lazyProduct(change);
  }
  l.jacobian = std::move(jacobian);
  return l;
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
