#include "sim/direct/refine.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/core/noise.hpp"
#include "sim/direct/detail/playback_machine.hpp"
#include "sim/direct/detail/search.hpp"
#include "sim/direct/detail/turning.hpp"
#include "sim/direct/integral.hpp"

namespace swingbank::sim::direct {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::size_t kAngleAndSpeed = 2;  ///< number of measured states: the first two of every machine

/// A machine with voltage, angle and speed played in from the record.
class MachinePlayback {
 public:
  MachinePlayback(const Effect& machine, const Recording& record, double longest)
      : machine_(machine), record_(record), first_(behind_last_leap(record)) {
    const auto count = std::min(static_cast<std::size_t>(longest / record.step), record.V.size() - first_);
    whole_ = turning(record, 0.0, 0.0, 0, first_ + count);
    steps_ = (count - 1) / 2;
  }
  [[nodiscard]] std::size_t fluxes() const { return machine_.states.size() - kAngleAndSpeed; }
  [[nodiscard]] Index outputs() const { return static_cast<Index>(steps_ * compared()); }

  /// Returns the residuals over the segment [pu]. `offset`: initial rotor angle minus its steady-state value
  /// [rad]; `flux`: fluxes at the segment's start.
  template <class T>
  std::vector<T> residuals(const std::vector<T>& p, const T& offset, const std::vector<T>& flux) const {
    Machine<T> m = machine(p);
    const T angle = m.x[0] + offset;
    std::vector<T> x = flux, out;
    out.reserve(steps_ * compared());
    for (std::size_t k = 0; k < steps_; ++k) {
      const std::size_t at = first_ + 2 * k;
      compare(m, at, angle, x, out);
      step(m, {at, at + 1, at + 2}, 2 * record_.step, angle, x);
    }
    return out;
  }
  /// Returns the fluxes at the segment's start, integrated from the steady state. The fault starts and ends
  /// between samples, so that the result is only a start value for the fit.
  std::vector<double> fluxes_at_start(const std::vector<double>& p) const {
    Machine<double> m = machine(p);
    const double angle = m.x[0];
    std::vector<double> x = fluxes(m.x);
    for (std::size_t k = 0; k < first_; ++k) step(m, {k, k, k + 1}, record_.step, angle, x);
    return x;
  }

 private:
  template <class T>
  using Machine = PlaybackMachine<T>;
  template <class T>
  [[nodiscard]] Machine<T> machine(const std::vector<T>& p) const {
    return {machine_,       record_.conventions,       p,
            T(whole_.V[0]), T(whole_.current0.real()), T(whole_.current0.imag())};
  }
  template <class T>
  [[nodiscard]] std::vector<T> fluxes(const std::array<T, kMostFlowing>& of) const {
    return {of.begin() + kAngleAndSpeed, of.begin() + machine_.states.size()};
  }
  [[nodiscard]] std::size_t compared() const { return whole_.Ifd.size() > 0 ? 3 : 2; }
  /// Evaluates the machine at a sample, with measured angle and speed and the given fluxes. `angle`: rotor
  /// angle at the first sample.
  template <class T>
  void evaluate(Machine<T>& m, std::size_t at, const T& angle, const std::vector<T>& flux) const {
    const auto i = static_cast<Index>(at);
    m.x[0] = angle + T(whole_.relative[i]);
    m.x[1] = T(whole_.speed[i]);
    std::ranges::copy(flux, m.x.begin() + kAngleAndSpeed);
    m.evaluate(T(whole_.V[i]));
  }
  template <class T>
  void compare(Machine<T>& m, std::size_t at, const T& angle, const std::vector<T>& flux,
               std::vector<T>& out) const {
    const auto i = static_cast<Index>(at);
    evaluate(m, at, angle, flux);
    // Current in the terminal's frame; `turning` returns it on axes that rotate with the rotor.
    const std::complex<double> current = whole_.current[i] * std::polar(1.0, whole_.relative[i]);
    out.push_back((m.s.Ir - T(current.real())) * m.xm);
    out.push_back((m.s.Ii - T(current.imag())) * m.xm);
    if (whole_.Ifd.size() > 0) out.push_back(m.s.Ifd - T(whole_.Ifd[i]));
  }
  template <class T>
  std::vector<T> derivatives(Machine<T>& m, std::size_t at, const T& angle,
                             const std::vector<T>& flux) const {
    evaluate(m, at, angle, flux);
    m.derive();
    return fluxes(m.dx);
  }
  /// Performs one integration step over the samples first, middle, last.
  template <class T>
  void step(Machine<T>& m, const std::array<std::size_t, 3>& at, double h, const T& angle,
            std::vector<T>& x) const {
    runge_kutta(x, derivatives(m, at[0], angle, x), h, [&](int stage, const std::vector<T>& y) {
      return derivatives(m, at[stage == 3 ? 2 : 1], angle, y);
    });
  }

  const Effect& machine_;
  const Recording& record_;
  std::size_t first_, steps_ = 0;
  Turning whole_;
};

/// Residuals and their derivatives for Ceres. Unknowns: free parameters, offset, fluxes; each divided by its
/// scale.
class Residuals : public DualCostFunction<Residuals> {
 public:
  Residuals(const MachinePlayback& playback, std::vector<double> p, std::span<const int> free, VectorXd scale)
      : DualCostFunction(static_cast<int>(playback.outputs()), static_cast<int>(scale.size())),
        playback_(playback),
        p_(std::move(p)),
        free_(free),
        scale_(std::move(scale)) {}
  [[nodiscard]] std::vector<double> parameters(const VectorXd& z) const {
    std::vector<double> p = p_;
    for (std::size_t k = 0; k < free_.size(); ++k)
      p[static_cast<std::size_t>(free_[k])] = z[static_cast<Index>(k)] * scale_[static_cast<Index>(k)];
    return p;
  }
  template <class T>
  std::vector<T> of(const double* z, Index first) const {
    const auto at = [&](Index k) { return unknown<T>(z, k, scale_[k], first); };
    std::vector<T> p(p_.begin(), p_.end()), flux;
    const auto n = static_cast<Index>(free_.size());
    for (Index k = 0; k < n; ++k) p[static_cast<std::size_t>(free_[static_cast<std::size_t>(k)])] = at(k);
    for (Index k = n + 1; k < scale_.size(); ++k) flux.push_back(at(k));
    return playback_.residuals<T>(p, at(n), flux);
  }

 private:
  const MachinePlayback& playback_;
  std::vector<double> p_;
  std::span<const int> free_;
  VectorXd scale_;
};

/// Returns the RMS residual [pu] up to which a fit counts as exact: three standard deviations of P before the
/// event, but at least the integration error with a record in single precision.
double exact(const Recording& record) {
  constexpr double kIntegration = 1e-5, kOfNoise = 3;  // [pu]; standard deviations
  const std::size_t n = std::max<std::size_t>(2, before_first_leap(record));
  double mean = 0, square = 0;
  for (std::size_t k = 0; k < n; ++k) mean += record.P[k] / static_cast<double>(n);
  for (std::size_t k = 0; k < n; ++k) square += std::pow(record.P[k] - mean, 2) / static_cast<double>(n - 1);
  return std::max(kIntegration, kOfNoise * std::sqrt(square));
}

/// Returns a start near `p`: each free parameter is halfway between its value in `p` and a random value
/// within its bounds.
std::vector<double> drawn_about(std::vector<double> p, std::uint32_t draw, std::span<const int> free,
                                std::span<const double> low, std::span<const double> high) {
  constexpr std::uint64_t kSeed = 1;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const double u = uniform_pair(kSeed, draw, k)[0];
    double& value = p[static_cast<std::size_t>(free[k])];
    value = 0.5 * (value + low[k] + u * (high[k] - low[k]));
  }
  return p;
}

}  // namespace

Refined refine_best(const Effect& machine, const Recording& record,
                    std::span<const std::vector<double>> candidates, std::span<const int> free,
                    std::span<const double> low, std::span<const double> high, const RefineOptions& options) {
  constexpr std::uint32_t kFurtherStarts = 8;
  if (machine.states.size() == kAngleAndSpeed) return {candidates.front(), 0};  // no fluxes to fit
  const double enough = exact(record);
  Refined best{candidates.front(), std::numeric_limits<double>::infinity()};
  const auto take = [&](const std::vector<double>& start) {
    Refined r = refine(machine, record, start, free, low, high, options);
    for (const int k : r.idle) {
      const auto i = static_cast<std::size_t>(free[static_cast<std::size_t>(k)]);
      r.p[i] = candidates.front()[i];
    }
    if (r.rms_error < best.rms_error) best = r;
  };
  for (std::size_t k = 0; k < candidates.size() && best.rms_error > enough; ++k) take(candidates[k]);
  for (std::uint32_t k = 0; k < kFurtherStarts && best.rms_error > enough; ++k)
    take(drawn_about(best.p, k, free, low, high));
  return best;
}

Refined refine(const Effect& machine, const Recording& record, std::vector<double> start,
               std::span<const int> free, std::span<const double> low, std::span<const double> high,
               const RefineOptions& options) {
  const MachinePlayback playback(machine, record, options.longest);
  const auto n = static_cast<Index>(free.size()), all = n + 1 + static_cast<Index>(playback.fluxes());
  VectorXd scale = VectorXd::Ones(all), z = VectorXd::Zero(all);
  for (Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(free[static_cast<std::size_t>(k)]);
    const auto b = static_cast<std::size_t>(k);
    start[i] = std::clamp(start[i], low[b], high[b]);
    scale[k] = high[b] - low[b];
    z[k] = start[i] / scale[k];
  }
  const auto flux = playback.fluxes_at_start(start);
  for (std::size_t k = 0; k < flux.size(); ++k) z[n + 1 + static_cast<Index>(k)] = flux[k];
  Residuals residuals(playback, start, free, scale);
  const double* blocks[] = {z.data()};
  VectorXd values(playback.outputs());
  RowMatrix jacobian(playback.outputs(), all);
  double* jacobians[] = {jacobian.data()};
  if (!residuals.Evaluate(blocks, values.data(), jacobians))
    return {start, std::numeric_limits<double>::infinity()};
  std::vector<int> idle;  // for example inertia and damping
  for (Index k = 0; k < n; ++k)
    if (jacobian.col(k).squaredNorm() == 0) idle.push_back(static_cast<int>(k));

  ceres::Problem::Options borrowed;
  borrowed.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(borrowed);
  problem.AddResidualBlock(&residuals, nullptr, z.data());
  if (!idle.empty()) problem.SetManifold(z.data(), new ceres::SubsetManifold(static_cast<int>(all), idle));
  for (Index k = 0; k < n; ++k) {
    const auto b = static_cast<std::size_t>(k);
    problem.SetParameterLowerBound(z.data(), static_cast<int>(k), low[b] / scale[k]);
    problem.SetParameterUpperBound(z.data(), static_cast<int>(k), high[b] / scale[k]);
  }
  ceres::Solver::Summary summary;
  constexpr double kSettled = 1e-9;
  ceres::Solve(search_options(options.iterations, kSettled), &problem, &summary);
  return {residuals.parameters(z),
          std::sqrt(2 * summary.final_cost / static_cast<double>(playback.outputs())),
          static_cast<int>(summary.iterations.size()) - 1, idle};
}

}  // namespace swingbank::sim::direct
