#include "sim/direct/detail/turning.hpp"

#include <algorithm>

#include "base/constants.hpp"
#include "sim/direct/integral.hpp"

namespace swingbank::sim::direct {
namespace {
using Complex = std::complex<double>;
constexpr double kNoVoltage = 1e-6;  ///< lower limit of V in the current S*/V, for bolted faults [pu]

Eigen::VectorXd column(const std::vector<double>& x, std::size_t first, std::size_t count) {
  return Eigen::Map<const Eigen::VectorXd>(x.data() + first, static_cast<Eigen::Index>(count));
}
}  // namespace

Turning turning(const Recording& r, double Ra, double X, std::size_t first, std::size_t count) {
  Turning t;
  count = std::min(count, r.V.size() - first);
  t.step = r.step;
  const auto current = [&](std::size_t k) { return Complex(r.P[k], -r.Q[k]) / std::max(r.V[k], kNoVoltage); };
  const auto behind = [&](std::size_t k) {
    const double turns = r.conventions.speed_voltage ? 1 + r.speed[k] : 1.0;
    return (r.V[k] + Complex(Ra, X) * current(k)) / turns;
  };
  const Eigen::VectorXd turned =
      constants::turn * r.conventions.frequency * integral(column(r.speed, 0, first + count), r.step);
  const auto n = static_cast<Eigen::Index>(count);
  t.flux.resize(n);
  t.current.resize(n);
  t.relative.resize(n);
  t.P.resize(n);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = first + k;
    const auto i = static_cast<Eigen::Index>(k);
    t.relative[i] = turned[static_cast<Eigen::Index>(at)] - (r.theta[at] - r.theta[0]);
    const Complex back = std::polar(1.0, -t.relative[i]), now = current(at);
    t.flux[i] = behind(at) * back;
    t.current[i] = now * back;
    t.P[i] = r.P[at] + Ra * std::norm(now);
  }
  t.V = column(r.V, first, count);
  t.speed = column(r.speed, first, count);
  t.flux0 = behind(0);
  t.current0 = current(0);
  t.P0 = r.P[0] + Ra * std::norm(t.current0);
  if (r.Ifd.empty()) return t;
  t.Ifd = column(r.Ifd, first, count);
  t.Ifd0 = r.Ifd[0];
  for (std::size_t k = 0; k < first; ++k) t.field_before += (t.Ifd0 - r.Ifd[k]) * r.step;
  return t;
}

}  // namespace swingbank::sim::direct
