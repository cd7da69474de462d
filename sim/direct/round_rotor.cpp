#include "sim/direct/round_rotor.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/direct/detail/line_search.hpp"
#include "sim/direct/detail/turning.hpp"
#include "sim/direct/integral.hpp"
#include "sim/direct/swing.hpp"

namespace swingbank::sim::direct {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLongest = 6.0;  ///< maximum segment length [s]; later samples contain little information
constexpr int kAngles = 161, kKnees = 61,
              kReactances = 201;   ///< grid points of the searches for angle, A and X'q
constexpr double kSaliency = 2.4;  ///< largest (Xq - X'')/(1 + ks Se) in the search [pu]

/// Least-squares solution of columns x = target with scaled columns; `left`: root mean square residual.
struct Solved {
  VectorXd x;
  double left = 0;
};
Solved solve(const MatrixXd& columns, const VectorXd& target, double samples) {
  const Eigen::RowVectorXd size = columns.colwise().norm().cwiseMax(1e-300);
  const MatrixXd scaled = columns.array().rowwise() / size.array();
  const VectorXd x = scaled.colPivHouseholderQr().solve(target);
  return {x.cwiseQuotient(size.transpose()), (target - scaled * x).norm() / std::sqrt(samples)};
}

/// Field circuit and d-axis damper, linear for a given angle:
///   int psi_d = -T''do (psi_d - psi_d0) + T''do gd1/T'do J + int J/T'do - (X'd - X'') int i_d + E'q0 t,
/// with J the integral of Efd - Ifd and gd1 = (X'' - Xl)/(X'd - Xl). Every column is independent of the
/// angle, or a sum of two such columns times the angle's cosine and sine. Their triangular factor is
/// therefore computed once.
class DirectAxis {
 public:
  explicit DirectAxis(const Turning& t) : samples_(static_cast<double>(t.V.size())) {
    const VectorXd forcing = VectorXd::Constant(t.Ifd.size(), t.Ifd0) - t.Ifd;
    J = integral(forcing, t.step);
    MatrixXd base(t.V.size(), kColumns);
    base.col(0) = integral(t.flux.real(), t.step);
    base.col(1) = integral(t.flux.imag(), t.step);
    base.col(2) = -(t.flux.real().array() - t.flux[0].real());
    base.col(3) = -(t.flux.imag().array() - t.flux[0].imag());
    base.col(4) = J;
    base.col(5) = integral(J, t.step);
    base.col(6) = integral(t.current.imag(), t.step);
    base.col(7) = -integral(t.current.real(), t.step);
    base.col(8) = VectorXd::LinSpaced(base.rows(), 0.0, t.step * static_cast<double>(base.rows() - 1));
    triangle_ = base.householderQr().matrixQR().topRows(kColumns).triangularView<Eigen::Upper>();
  }
  /// Returns T''do, T''do gd1/T'do, 1/T'do, X'd - X'', and E'q at the segment's start.
  [[nodiscard]] Solved at(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    MatrixXd columns(kColumns, 5);
    columns.col(0) = c * triangle_.col(2) + s * triangle_.col(3);
    columns.col(1) = triangle_.col(4);
    columns.col(2) = triangle_.col(5);
    columns.col(3) = c * triangle_.col(6) + s * triangle_.col(7);
    columns.col(4) = triangle_.col(8);
    return solve(columns, c * triangle_.col(0) + s * triangle_.col(1), samples_);
  }
  VectorXd J;

 private:
  static constexpr Index kColumns = 9;
  double samples_;
  MatrixXd triangle_;
};

/// Fluxes and currents on the rotor's axes.
struct Axes {
  VectorXd psi_d, psi_q, i_d, i_q;
  Axes(const Turning& t, double angle) {
    const std::complex<double> back = std::polar(1.0, -angle);
    const Eigen::VectorXcd flux = t.flux * back, current = t.current * back;
    psi_d = flux.real();
    psi_q = flux.imag();
    i_q = current.real();
    i_d = -current.imag();
  }
};

double se(double a, double b, double psi) { return b * std::pow(std::max(psi - a, 0.0), 2) / psi; }

/// Xd and saturation. The field current above E'q is (Xd - X'd)(i_d - kd td) + psi_d Se, with kd = (X'd -
/// X'')/(X'd - Xl)^2 and td = psi_1d + (X'd - Xl) i_d - E'q. This equation is linear in Xd - X'd and B for a
/// given A.
struct Field {
  double dXd = 0, A = 0, B = 0, left = 0;
};
Field field(const VectorXd& beyond, const VectorXd& armature, const Axes& axes) {
  const auto at = [&](double A) {
    Field f;
    f.A = A;
    const Eigen::ArrayXd psi = (axes.psi_d.array().square() + axes.psi_q.array().square()).sqrt();
    const VectorXd saturation = axes.psi_d.array() * (psi - A).max(0.0).square() / psi;
    const double gg = armature.squaredNorm(), gs = armature.dot(saturation),
                 ss = saturation.squaredNorm() + 1e-9;
    const double bg = armature.dot(beyond), bs = saturation.dot(beyond),
                 det = gg * ss - gs * gs + 1e-12 * gg * ss;
    f.dXd = (bg * ss - bs * gs) / det;
    f.B = (bs * gg - bg * gs) / det;
    if (f.B < 0) {
      f.B = 0;
      f.dXd = bg / gg;
    }
    f.left =
        (beyond - f.dXd * armature - f.B * saturation).norm() / std::sqrt(static_cast<double>(beyond.size()));
    return f;
  };
  constexpr double kLowestKnee = -1.2,
                   kHighestKnee = 1.0;  // range of A: S1.2 = S1.0 to S1.0 = 0
  const auto found = minima([&](double A) { return at(A).left; }, kLowestKnee, kHighestKnee, kKnees);
  return at(found.front().at);
}

/// X'q, T'qo and T''qo from the three coefficients of the q-axis equation.
struct Dampers {
  double Xqp = 0, Tqop = 0, Tqopp = 0;
};
Dampers dampers(double A1, double A2, double B1, double Xq, double Xl, double Xdpp) {
  const auto at = [&](double Xqp, Dampers* d) {
    const double dXq = Xq - Xqp, small = Xqp - Xdpp, leak = Xqp - Xl;
    const double c = 1 + dXq * small / (leak * leak);
    const double inside = A1 * A1 - 4 * c * A2;
    const double T = (A1 + std::sqrt(std::max(inside, 0.0))) / 2, Tpp = A2 / std::max(T, 1e-3);
    const double g = (Xdpp - Xl) / leak, m = dXq / leak;
    if (d) *d = {Xqp, T, Tpp};
    return std::abs(small * T + Tpp * g * (dXq - m * small) - B1) + 1e-2 * std::max(-inside, 0.0);
  };
  constexpr double kOffEnds = 0.01;  // distance from both ends of the interval [pu]
  const auto found = minima([&](double x) { return at(x, nullptr); }, Xdpp + kOffEnds,
                            std::max(Xq - kOffEnds, Xdpp + 2 * kOffEnds), kReactances);
  Dampers d;
  at(found.front().at, &d);
  return d;
}

struct QuadratureAxis {
  double Xq = 0, ks = 0, left = 0;
  Dampers dampers;
};
/// Equation of the q axis with both dampers, integrated twice:
///   iint psi_q = -A1 int psi_q - A2 psi_q - (Xq - X'') iint i_q - B1 int i_q
///                - ks iint sigma - C1 int sigma + straight line
/// with sigma = psi_q Se and ks = (Xq - Xl)/(Xd - Xl). Fitted: A1, A2, Xq - X'', B1, C1, straight line. ks
/// depends on Xq and is iterated; four passes suffice.
QuadratureAxis quadrature(const Axes& axes, double step, double A, double B, const RoundRotor& r) {
  const Index n = axes.psi_q.size();
  VectorXd saturation(n);
  for (Index k = 0; k < n; ++k)
    saturation[k] = axes.psi_q[k] * se(A, B, std::hypot(axes.psi_d[k], axes.psi_q[k]));
  const VectorXd flux = integral(axes.psi_q, step), current = integral(axes.i_q, step);
  const VectorXd field = integral(saturation, step), field2 = integral(field, step),
                 flux2 = integral(flux, step);
  MatrixXd columns(n, 7);
  columns << -flux, -axes.psi_q, -integral(current, step), -current, -field,
      VectorXd::LinSpaced(n, 0.0, step * static_cast<double>(n - 1)), VectorXd::Ones(n);
  const Eigen::RowVectorXd size = columns.colwise().norm().cwiseMax(1e-300);
  columns.array().rowwise() /= size.array();
  const auto qr = columns.colPivHouseholderQr();
  QuadratureAxis q;
  q.Xq = 1.4;  // start value [pu]: middle of the usual range
  VectorXd x;
  for (int pass = 0; pass < 4; ++pass) {
    q.ks = (q.Xq - r.Xl) / (r.Xd - r.Xl);
    const VectorXd target = flux2 + q.ks * field2;
    x = qr.solve(target);
    q.left = (target - columns * x).norm() / std::sqrt(static_cast<double>(n));
    q.Xq = std::max(x[2] / size[2] + r.Xdpp, r.Xdpp + 0.05);
  }
  q.dampers = dampers(x[0] / size[0], x[1] / size[1], x[3] / size[3], q.Xq, r.Xl, r.Xdpp);
  return q;
}

double least(double value, double floor) { return std::isfinite(value) ? std::max(value, floor) : floor; }

/// Estimates all other parameters for a given angle.
RoundRotor chain(const Turning& t, const DirectAxis& d, const Minimum& angle, const RoundRotor& known) {
  RoundRotor r = known;
  r.angle = angle.at;
  const VectorXd x = d.at(angle.at).x;
  r.Tdopp = std::clamp(least(x[0], 0.005), 0.005, 0.5);
  r.Tdop = 1 / std::clamp(least(x[2], 0.05), 0.05, 2.0);
  r.Xdp = r.Xdpp + least(x[3], 0.01);
  const double gd1 = std::clamp(least(x[1] * r.Tdop / r.Tdopp, 0.01), 0.01, 0.95);
  r.Xl = std::clamp((r.Xdpp - gd1 * r.Xdp) / (1 - gd1), 0.0, 0.95 * r.Xdpp);
  const Axes axes(t, r.angle);
  const double g = (r.Xdpp - r.Xl) / (r.Xdp - r.Xl), dX = r.Xdp - r.Xl;
  const VectorXd Eq = d.J / r.Tdop + VectorXd::Constant(d.J.size(), x[4]);
  const VectorXd psi1 = (axes.psi_d - g * Eq) / (1 - g);
  const VectorXd armature = axes.i_d - (r.Xdp - r.Xdpp) / (dX * dX) * (psi1 + dX * axes.i_d - Eq);
  const Field f = field(t.Ifd - Eq, armature, axes);
  r.Xd = std::max(r.Xdp + f.dXd, r.Xdp + 0.01);
  r.S10 = f.B * std::pow(std::max(1 - f.A, 0.0), 2);
  r.S12 = f.B * std::pow(std::max(1.2 - f.A, 0.0), 2) / 1.2;
  const QuadratureAxis q = quadrature(axes, t.step, f.A, f.B, r);
  r.Xq = q.Xq;
  r.Xqp = q.dampers.Xqp;
  r.Tqop = q.dampers.Tqop;
  r.Tqopp = q.dampers.Tqopp;
  // The steady state gives a second estimate of the angle.
  const double k = (r.Xq - r.Xdpp) / (1 + q.ks * se(f.A, f.B, std::abs(t.flux0)));
  const double steady = std::arg(t.flux0 + std::complex<double>(0, k) * t.current0);
  r.rms_error = std::log(angle.value + 1e-7) + std::log(f.left + 1e-5) + std::log(q.left + 1e-6) +
                std::log(std::abs(steady - r.angle) + 1e-3);
  return r;
}

}  // namespace

std::vector<RoundRotor> round_rotor(const Recording& record, double Ra, double Xdpp) {
  const std::size_t first = behind_last_leap(record);
  const auto count = static_cast<std::size_t>(kLongest / record.step);
  if (record.Ifd.empty() || first + kShortestStretch > record.V.size()) return {};
  const Turning t = turning(record, Ra, Xdpp, first, count);
  const Swing rotor = swing_of(record, Ra, Divided::driving);
  RoundRotor known;
  known.Xdpp = Xdpp;
  known.H = rotor.H;
  known.D = rotor.D;
  const DirectAxis d(t);
  const double lowest = std::arg(t.flux0);
  const double highest = std::arg(t.flux0 + std::complex<double>(0, kSaliency) * t.current0);
  const auto found = minima([&](double angle) { return d.at(angle).left; }, std::min(lowest, highest),
                            std::max(lowest, highest), kAngles);
  std::vector<RoundRotor> all;
  for (std::size_t k = 0; k < std::min<std::size_t>(found.size(), 3); ++k)
    all.push_back(chain(t, d, found[k], known));
  std::ranges::sort(all, {}, &RoundRotor::rms_error);
  return all;
}

}  // namespace swingbank::sim::direct
