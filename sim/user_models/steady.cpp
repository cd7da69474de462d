// Steady state of a user-defined model: states and unknown references for which all derivatives vanish and
// the output has its prescribed value. Newton's method uses a Jacobian from dual numbers and needs one step
// for a linear model. Its minimum-norm steps leave undetermined unknowns at their initial values.
#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>

#include "sim/user_models/detail/definition.hpp"

namespace swingbank::sim::user_models {

bool Definition::must_meet() const {
  const auto is = [&](std::string_view n) { return output_name() == n; };
  return is("Efd") || is("Tm") || is("dVref") || is("dPref");
}

namespace {

using Eigen::Index;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
constexpr double kTolerance =
    1e-9;  ///< as in operating_point; rounding of cancelling derivatives: about 1e-14

class Search {
 public:
  Search(const Definition& user_model, double* c, const Signals<double>& s, double* x)
      : user_model_(user_model), c_(c), s_(s), x_(x), states_(static_cast<Index>(user_model.states.size())) {
    unknowns_ = states_ + static_cast<Index>(user_model.searched.size());
    rows_ = states_ + (user_model.must_meet() ? 1 : 0);
    s_.t = -1.0;  // before any switching time
    for (Index i = 0; i < states_; ++i) x_[i] = c_[user_model.start[static_cast<std::size_t>(i)]];
    for (const int i : user_model.searched) c_[i] = 0.0;
  }

  std::string run() {
    if (rows_ == 0 || unknowns_ == 0) return verdict();
    Vector rest = residual();
    if (!rest.allFinite()) return no_number(rest);
    constexpr int limit = 60;
    for (int iteration = 0; iteration < limit && improve(rest); ++iteration) {
    }
    return verdict();
  }

  /// Returns the solution u of J u = `by`. If `by` is the derivative of the residual, -u is the derivative of
  /// the unknowns.
  [[nodiscard]] Vector follow(const Vector& by) { return solve(by); }
  template <class T>
  static std::vector<T> residual_of(const Definition& user_model, const T* c, const T* x,
                                    const Signals<T>& s) {
    std::vector<T> f(user_model.states.size(), T(0.0));
    Registers<T> registers;
    T output(0.0);
    user_models::run<T, true>(user_model.code.loop, c, x, s, registers.data(), f.data(), output);
    if (user_model.must_meet())
      f.push_back(user_model.replaces ? output - s.*kMembers<T>[static_cast<std::size_t>(user_model.output)]
                                      : output);
    return f;
  }

 private:
  [[nodiscard]] Vector unknowns() const {
    Vector u(unknowns_);
    for (Index i = 0; i < states_; ++i) u[i] = x_[i];
    for (Index i = states_; i < unknowns_; ++i) u[i] = c_[searched(i)];
    return u;
  }
  void set(const Vector& u) {
    for (Index i = 0; i < states_; ++i) x_[i] = u[i];
    for (Index i = states_; i < unknowns_; ++i) c_[searched(i)] = u[i];
  }
  [[nodiscard]] int searched(Index i) const {
    return user_model_.searched[static_cast<std::size_t>(i - states_)];
  }
  [[nodiscard]] Vector residual() const {
    const auto f = residual_of<double>(user_model_, c_, x_, s_);
    return Eigen::Map<const Vector>(f.data(), rows_);
  }
  [[nodiscard]] Matrix jacobian() const {
    const auto size = static_cast<std::size_t>(user_model_.code.coefficients);
    std::vector<D8> c(c_, c_ + size), x(x_, x_ + states_);
    Signals<D8> s;
    for (std::size_t i = 0; i < kSignals.size(); ++i) s.*kMembers<D8>[i] = D8(s_.*kMembers<double>[i]);
    const auto unknown = [&](Index i) -> D8& {
      return i < states_ ? x[static_cast<std::size_t>(i)] : c[static_cast<std::size_t>(searched(i))];
    };
    Matrix j(rows_, unknowns_);
    for (Index from = 0; from < unknowns_; from += kSensitivities) {
      const Index to = std::min<Index>(from + kSensitivities, unknowns_);
      for (Index i = from; i < to; ++i) unknown(i).d.set(static_cast<int>(i - from), 1.0);
      const auto f = residual_of<D8>(user_model_, c.data(), x.data(), s);
      for (Index row = 0; row < rows_; ++row)
        for (Index i = from; i < to; ++i)
          j(row, i) = f[static_cast<std::size_t>(row)].d[static_cast<int>(i - from)];
      for (Index i = from; i < to; ++i) unknown(i).d = 0.0;
    }
    return j;
  }
  /// Returns the minimum-norm solution of J u = rest. Rows are scaled by their largest entry, because time
  /// constants differ by orders of magnitude.
  [[nodiscard]] Vector solve(const Vector& rest) const {
    Matrix j = jacobian();
    if (!j.allFinite()) return Vector::Constant(unknowns_, std::numeric_limits<double>::quiet_NaN());
    Vector f = rest;
    for (Index row = 0; row < rows_; ++row) {
      const double largest = j.row(row).cwiseAbs().maxCoeff();
      if (largest == 0.0) continue;
      j.row(row) /= largest;
      f[row] /= largest;
    }
    return j.completeOrthogonalDecomposition().solve(f);
  }
  /// Takes one Newton step, halved until the residual decreases. Returns false if it does not decrease.
  bool improve(Vector& rest) {
    constexpr int halvings = 30;
    const Vector step = solve(rest), before = unknowns();
    if (!step.allFinite()) return false;
    double part = 1.0;
    for (int k = 0; k < halvings; ++k, part /= 2) {
      set(before - part * step);
      const Vector next = residual();
      if (!next.allFinite() || !(next.norm() < rest.norm())) continue;
      rest = next;
      return true;
    }
    set(before);
    return false;
  }
  [[nodiscard]] std::string no_number(const Vector& rest) const {
    for (Index i = 0; i < states_; ++i)
      if (!std::isfinite(rest[i]))
        return fmt::format("the derivative of {} is not a finite number at the operating point",
                           user_model_.states[static_cast<std::size_t>(i)].name);
    return fmt::format("its {} is not a finite number at the operating point", user_model_.output_name());
  }
  /// Returns true if a limit clamps the state against its derivative.
  [[nodiscard]] bool is_clamped(std::size_t i, double dx) const {
    const State& state = user_model_.states[i];
    return (state.low >= 0 && x_[i] <= c_[state.low] && dx < 0.0) ||
           (state.high >= 0 && x_[i] >= c_[state.high] && dx > 0.0);
  }
  /// Returns the reason if the result, with its limits active, is no steady state; else "". Also returns ""
  /// for a state outside its limits, which the caller reports.
  [[nodiscard]] std::string verdict() const {
    for (std::size_t i = 0; i < user_model_.states.size(); ++i) {
      const State& state = user_model_.states[i];
      if ((state.low >= 0 && x_[i] < c_[state.low] - kTolerance) ||
          (state.high >= 0 && x_[i] > c_[state.high] + kTolerance))
        return {};
    }
    std::vector<double> dx(user_model_.states.size(), 0.0);
    Registers<double> registers;
    double output = 0.0;
    user_models::run<double, false>(user_model_.code.loop, c_, x_, s_, registers.data(), dx.data(), output);
    for (std::size_t i = 0; i < dx.size(); ++i)
      if (!(std::abs(dx[i]) < kTolerance) && !is_clamped(i, dx[i]))
        return fmt::format("state {} has no steady state: it changes by {:.4g} per second at {:.4g} {}",
                           user_model_.states[i].name, dx[i], x_[i], user_model_.states[i].unit);
    const double asked = user_model_.must_meet() && user_model_.replaces
                             ? s_.*kMembers<double>[static_cast<std::size_t>(user_model_.output)]
                             : 0.0;
    if (!std::isfinite(output))
      return fmt::format("its {} is not a finite number at the operating point", user_model_.output_name());
    if (!user_model_.must_meet() || std::abs(output - asked) < kTolerance) return {};
    if (user_model_.replaces)
      return fmt::format(
          "it gives {} = {:.6g} pu, but the machine needs {:.6g} pu; declare a reference = \"solve\"",
          user_model_.output_name(), output, asked);
    return fmt::format(
        "it adds {:.6g} pu to {} in the steady state (subtract the value at the operating "
        "point, as in V - V0)",
        output, user_model_.output_name());
  }

  const Definition& user_model_;
  double* c_;
  Signals<double> s_;
  double* x_;
  Index states_, unknowns_ = 0, rows_ = 0;
};

/// Writes the output for later controls, if the operating point does not prescribe it.
template <class T>
void put_out(const Definition& user_model, const T* c, const T* x, Signals<T>& s) {
  if (user_model.must_meet()) return;
  Signals<T> now = s;
  now.t = T(-1.0);
  std::vector<T> dx(user_model.states.size(), T(0.0));
  Registers<T> registers;
  T output(0.0);
  run<T, false>(user_model.code.loop, c, x, now, registers.data(), dx.data(), output);
  T& to = s.*kMembers<T>[static_cast<std::size_t>(user_model.output)];
  to = user_model.replaces ? output : to + output;
}

}  // namespace

std::string steady(const Definition& user_model, const double* p, double* c, Signals<double>& s, double* x) {
  fill(user_model, p, &s, c);
  std::string why = Search(user_model, c, s, x).run();
  if (why.empty()) put_out(user_model, c, x, s);
  return why;
}

/// Computes the values in double precision, and the derivatives by the implicit function theorem.
std::string steady(const Definition& user_model, const D8* p, D8* c, Signals<D8>& s, D8* x) {
  const std::size_t states = user_model.states.size();
  std::vector<double> pd, cd(static_cast<std::size_t>(user_model.code.coefficients), 0.0), xd(states);
  for (std::size_t i = 0; i < user_model.parameters.size(); ++i) pd.push_back(p[i].a);
  cd[kFrequency] = c[kFrequency].a;
  Signals<double> sd;
  for (std::size_t i = 0; i < kSignals.size(); ++i) sd.*kMembers<double>[i] = (s.*kMembers<D8>[i]).a;
  fill(user_model, pd.data(), &sd, cd.data());
  Search search(user_model, cd.data(), sd, xd.data());
  const std::string why = search.run();
  if (!why.empty()) return why;
  fill(user_model, p, &s, c);
  for (std::size_t i = 0; i < states; ++i) x[i] = D8(xd[i]);
  for (const int i : user_model.searched) c[i] = D8(cd[static_cast<std::size_t>(i)]);
  Signals<D8> now = s;
  now.t = D8(-1.0);
  const auto f = Search::residual_of<D8>(user_model, c, x, now);
  if (!f.empty() && states + user_model.searched.size() > 0)
    for (int k = 0; k < kSensitivities; ++k) {
      Vector by(static_cast<Index>(f.size()));
      for (std::size_t i = 0; i < f.size(); ++i) by[static_cast<Index>(i)] = f[i].d[k];
      const Vector u = search.follow(by);
      for (std::size_t i = 0; i < states; ++i) x[i].d.set(k, -u[static_cast<Index>(i)]);
      for (std::size_t i = 0; i < user_model.searched.size(); ++i)
        c[user_model.searched[i]].d.set(k, -u[static_cast<Index>(states + i)]);
    }
  put_out(user_model, c, x, s);
  return {};
}

}  // namespace swingbank::sim::user_models
