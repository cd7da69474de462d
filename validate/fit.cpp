#include "validate/fit.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace swingbank::validate {
namespace {

using Kind = Direction::Kind;

constexpr int kStates = 4;  ///< P, Q, angle, speed
/// One unit of each, as the search steps: far below any effect, far above rounding.
constexpr double kStateScale[kStates] = {1e-3, 1e-3, 1e-3, 1e-5};
constexpr Kind kStateKind[kStates] = {Kind::P, Kind::Q, Kind::angle, Kind::speed};
/// What a start is believed to be off by, in those units: a plant before an event nearly stands still.
constexpr double kStateBelief[kStates] = {20, 20, 20, 20};
constexpr double kSwitchScale = 1e-3;  ///< [s]

/// A free parameter as the search sees it: z = 0 at the start, steps of order 1.
struct Axis {
  FreeParameter where;
  double start, low, high;  ///< of the parameter
  bool logarithmic;
  double unit;  ///< of z, where linear
  [[nodiscard]] double value(double z) const { return logarithmic ? start * std::exp(z) : start + unit * z; }
  [[nodiscard]] double slope(double z) const { return logarithmic ? value(z) : unit; }
  [[nodiscard]] double z(double v) const { return logarithmic ? std::log(v / start) : (v - start) / unit; }
  /// Standard deviation of the belief in z.
  [[nodiscard]] double spread() const { return where.spread; }
};

Axis make_axis(const sim::Plant& plant, const FreeParameter& f) {
  const sim::Parameter& record = parameter_record(plant, f.block, f.index);
  const double start =
      sim::block_parameters(plant)[static_cast<std::size_t>(f.block)][static_cast<std::size_t>(f.index)];
  Axis a{f, start, record.low, record.high, start > 0, 1.0};
  if (a.logarithmic) {
    a.low = std::max(a.low, 1e-3 * start);
    a.high = std::min(a.high, 1e3 * start);
  } else {
    a.unit = start != 0 ? std::abs(start) : 0.05 * std::min(record.high - record.low, 20.0);
  }
  return a;
}

/// What stands fixed during a fit.
struct Setting {
  const sim::Plant* plant;
  const sim::Conventions* conventions;
  const std::vector<FitEvent>* events;
  std::vector<Axis> axes;
  double tolerance;
  InputKind input;
  std::vector<std::vector<double>> knots;  ///< of the input, per event [s]
};

sim::Plant moved(const Setting& s, const double* z) {
  sim::Plant plant = *s.plant;
  for (std::size_t i = 0; i < s.axes.size(); ++i)
    parameter_value(plant, s.axes[i].where.block, s.axes[i].where.index) = s.axes[i].value(z[i]);
  return plant;
}
/// Parameters no equation can be run with.
bool possible(const sim::Plant& plant) {
  Problems problems;
  const auto check = [&](const sim::Block& b) {
    b.effect->check(b.effect->law.get(), b.p.data(), "", problems);
  };
  check(plant.machine);
  if (plant.transformer.effect) check(plant.transformer);
  for (const auto& b : plant.controls) check(b);
  return problems.list().empty();
}

/// Residuals of one event; parameter blocks: z of the plant (absent if none is free), state of the event.
class EventCost : public ceres::CostFunction {
 public:
  EventCost(const Setting& setting, std::size_t event)
      : setting_(setting), event_((*setting.events)[event]), knots_(setting.knots[event]) {
    set_num_residuals(event_.values());
    if (!setting.axes.empty())
      mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(setting.axes.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(state_size()));
  }
  [[nodiscard]] std::size_t state_size() const { return event_.switchings.size() + kStates + knots_.size(); }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const bool has_axes = !setting_.axes.empty();
    const double* z = has_axes ? blocks[0] : nullptr;
    const double* state = blocks[has_axes ? 1 : 0];
    double* by_z = jacobians && has_axes ? jacobians[0] : nullptr;
    double* by_state = jacobians ? jacobians[has_axes ? 1 : 0] : nullptr;
    const sim::Plant plant = moved(setting_, z);
    if (!possible(plant)) return false;
    std::vector<Direction> along;
    if (by_z)
      for (std::size_t i = 0; i < setting_.axes.size(); ++i) {
        const Axis& a = setting_.axes[i];
        along.push_back({Kind::parameter, a.where.block, a.where.index, a.slope(z[i])});
      }
    const std::size_t states_at = along.size();
    if (by_state) add_state_directions(along);
    try {
      auto switchings = event_.switchings;
      const Drive run = make_drive(plant, state, switchings);
      const VoltageCurve curve(event_.played(), switchings);
      Drive with = run;
      with.curve = &curve;
      const Response r = drive(with, along);
      write(r.value, true, residuals, 1, 0);
      const int nz = static_cast<int>(setting_.axes.size());
      const int ns = static_cast<int>(state_size());
      for (std::size_t d = 0; d < along.size(); ++d)
        if (d < states_at)
          write(r.slopes[d].value, false, by_z, nz, static_cast<int>(d));
        else
          write(r.slopes[d].value, false, by_state, ns, static_cast<int>(d - states_at));
    } catch (const InputError&) {
      return false;
    }
    return true;
  }
  /// The run at a state; `switchings` get their moved instants.
  Drive make_drive(const sim::Plant& plant, const double* state, std::vector<Switching>& switchings) const {
    for (std::size_t k = 0; k < switchings.size(); ++k)
      switchings[k].time = event_.switchings[k].time + kSwitchScale * state[k];
    const double* s = state + switchings.size();
    Drive run{.plant = &plant, .conventions = *setting_.conventions, .record = &event_.record};
    run.start = event_.start;
    run.start.P += kStateScale[0] * s[0];
    run.start.Q += kStateScale[1] * s[1];
    run.angle = kStateScale[2] * s[2];
    run.speed = kStateScale[3] * s[3];
    run.tolerance = setting_.tolerance;
    // a limit that is met and left within a sample is no reason for short steps
    run.least_step = event_.record.step() / 40;
    run.step_limit = 15 * event_.record.samples();
    if (setting_.input == InputKind::none) return run;
    PiecewiseLinear& input = setting_.input == InputKind::torque ? run.torque : run.field;
    input.t = knots_;
    input.value.assign(s + kStates, s + kStates + knots_.size());
    return run;
  }

 private:
  void add_state_directions(std::vector<Direction>& along) const {
    for (std::size_t k = 0; k < event_.switchings.size(); ++k)
      along.push_back({Kind::switching, 0, static_cast<int>(k), kSwitchScale});
    for (int k = 0; k < kStates; ++k) along.push_back({kStateKind[k], 0, 0, kStateScale[k]});
    const Kind kind = setting_.input == InputKind::torque ? Kind::torque : Kind::field;
    for (std::size_t k = 0; k < knots_.size(); ++k) along.push_back({kind, 0, static_cast<int>(k), 1.0});
  }
  /// Whitened values (less the measured ones) into column `column` of a matrix of `stride` columns.
  void write(const std::vector<double>* values, bool less_measured, double* to, int stride,
             int column) const {
    const auto n = static_cast<Eigen::Index>(event_.channels.size());
    Eigen::VectorXd e(n);
    Eigen::Index row = 0;
    for (int k = 0; k < event_.record.samples(); ++k) {
      if (!event_.compared(static_cast<std::size_t>(k))) continue;
      for (Eigen::Index c = 0; c < n; ++c) {
        const Output o = event_.channels[static_cast<std::size_t>(c)];
        e[c] = values[static_cast<int>(o)][static_cast<std::size_t>(k)];
        if (less_measured) e[c] -= event_.measured(o)[static_cast<std::size_t>(k)];
      }
      const Eigen::VectorXd w = event_.whitening * e;
      for (Eigen::Index c = 0; c < n; ++c) to[row++ * stride + column] = w[c];
    }
  }

  const Setting& setting_;
  const FitEvent& event_;
  const std::vector<double>& knots_;
};

/// Bends of an input that begins at `first` of the event's state, in units of `bend`; the first knot and the
/// first slope count as bends from zero, so that nothing is inferred before it is needed.
class Bends : public ceres::CostFunction {
 public:
  Bends(std::size_t size, std::size_t first, double bend) : size_(size), first_(first), weight_(1 / bend) {
    set_num_residuals(static_cast<int>(size - first));
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(size));
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const double* u = blocks[0] + first_;
    const std::size_t n = size_ - first_;
    double* j = jacobians ? jacobians[0] : nullptr;
    if (j) std::fill(j, j + n * size_, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
      const double one = k >= 1 ? u[k - 1] : 0.0, two = k >= 2 ? u[k - 2] : 0.0;
      residuals[k] = weight_ * (u[k] - 2 * one + two);
      if (!j) continue;
      double* row = j + k * size_ + first_;
      row[k] = weight_;
      if (k >= 1) row[static_cast<std::ptrdiff_t>(k) - 1] = -2 * weight_;
      if (k >= 2) row[static_cast<std::ptrdiff_t>(k) - 2] = weight_;
    }
    return true;
  }

 private:
  std::size_t size_, first_;
  double weight_;
};

/// z/spread, one residual each, in units of the misfit reached.
class Belief : public ceres::CostFunction {
 public:
  Belief(std::vector<double> spread, const double* discrepancy)
      : spread_(std::move(spread)), discrepancy_(discrepancy) {
    set_num_residuals(static_cast<int>(spread_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<std::int32_t>(spread_.size()));
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const std::size_t n = spread_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const double weight = spread_[i] > 0 ? std::sqrt(*discrepancy_) / spread_[i] : 0.0;
      residuals[i] = weight * blocks[0][i];
      if (jacobians && jacobians[0])
        for (std::size_t j = 0; j < n; ++j) jacobians[0][i * n + j] = i == j ? weight : 0.0;
    }
    return true;
  }

 private:
  std::vector<double> spread_;
  const double* discrepancy_;
};

class Search {
 public:
  Search(const Setting& setting, const FitOptions& options) : setting_(setting), options_(options) {
    z_.assign(setting.axes.size(), 0.0);
    for (std::size_t i = 0; i < options.values.size(); ++i) {
      const Axis& axis = setting.axes[i];
      z_[i] = axis.z(
          std::clamp(options.values[i], std::min(axis.low, axis.start), std::max(axis.high, axis.start)));
    }
    const auto& events = *setting.events;
    ceres::Problem::Options owned;
    problem_ = std::make_unique<ceres::Problem>(owned);
    for (std::size_t e = 0; e < events.size(); ++e) states_.push_back(start_of(e));
    for (std::size_t e = 0; e < events.size(); ++e) add_event(e);
    if (!z_.empty()) add_beliefs();
  }

  Fit run() {
    Fit fit;
    double cost = 0;
    if (!problem_->Evaluate({}, &cost, nullptr, nullptr, nullptr)) {
      fit.failed = reason();
      return fit;
    }
    for (int left = options_.iterations; left > 0;) {
      const double before = discrepancy_ = misfit();
      const int most = before > kClose ? std::min(left, kRound) : left;
      fit.converged = solve(most, fit.iterations);
      left = options_.iterations - fit.iterations;
      if (before <= kClose || misfit() > 0.95 * before) break;
    }
    fit.plant = moved(setting_, z_.data());
    collect_events(fit);
    collect_parameters(fit);
    return fit;
  }

 private:
  static constexpr double kClose = 1.5;  ///< misfit at which beliefs count as they stand
  static constexpr int kRound = 4;       ///< iterations between two looks at the misfit

  /// chi2 per value, at least 1.
  double misfit() const {
    double chi2 = 0;
    int values = 0;
    for (std::size_t e = 0; e < costs_.size(); ++e) {
      std::vector<double> residual(static_cast<std::size_t>(costs_[e]->num_residuals()));
      std::vector<const double*> blocks;
      if (!z_.empty()) blocks.push_back(z_.data());
      blocks.push_back(states_[e].data());
      if (!costs_[e]->Evaluate(blocks.data(), residual.data(), nullptr)) return 1.0;
      for (const double r : residual) chi2 += r * r;
      values += costs_[e]->num_residuals();
    }
    return std::max(1.0, chi2 / values);
  }
  /// One search of at most so many iterations; true if it converged.
  bool solve(int iterations, int& done) {
    ceres::Solver::Options o;
    o.max_num_iterations = iterations;
    o.function_tolerance = options_.enough;
    o.linear_solver_type =
        setting_.input == InputKind::none ? ceres::DENSE_NORMAL_CHOLESKY : ceres::SPARSE_NORMAL_CHOLESKY;
    o.logging_type = ceres::SILENT;
    o.num_threads = 1;  // hypotheses run side by side
    o.initial_trust_region_radius = 1e2;
    o.max_num_consecutive_invalid_steps = 12;
    ceres::Solver::Summary summary;
    ceres::Solve(o, problem_.get(), &summary);
    done += std::max(1, static_cast<int>(summary.iterations.size()) - 1);
    return summary.termination_type == ceres::CONVERGENCE;
  }

  std::vector<double> start_of(std::size_t e) const {
    const FitEvent& event = (*setting_.events)[e];
    std::vector<double> s(event.switchings.size() + kStates + setting_.knots[e].size(), 0.0);
    if (options_.start.empty()) return s;
    const EventState& from = options_.start[e];
    for (std::size_t k = 0; k < event.switchings.size(); ++k)
      s[k] = (from.switchings[k] - event.switchings[k].time) / kSwitchScale;
    const double values[kStates] = {from.P, from.Q, from.angle, from.speed};
    for (std::size_t k = 0; k < kStates; ++k) s[event.switchings.size() + k] = values[k] / kStateScale[k];
    if (setting_.input != InputKind::none)
      std::ranges::copy(from.input.value, s.end() - static_cast<std::ptrdiff_t>(from.input.value.size()));
    return s;
  }
  void add_event(std::size_t e) {
    const FitEvent& event = (*setting_.events)[e];
    auto* cost = new EventCost(setting_, e);  // the problem owns it
    costs_.push_back(cost);
    std::vector<double*> blocks;
    if (!z_.empty()) blocks.push_back(z_.data());
    blocks.push_back(states_[e].data());
    problem_->AddResidualBlock(cost, nullptr, blocks);
    std::vector<double> spread(event.switchings.size(), 0.0);
    spread.insert(spread.end(), std::begin(kStateBelief), std::end(kStateBelief));
    spread.resize(states_[e].size(), 0.0);
    problem_->AddResidualBlock(new Belief(spread, &discrepancy_), nullptr, {states_[e].data()});
    if (const std::size_t first = event.switchings.size() + kStates; first < states_[e].size())
      problem_->AddResidualBlock(new Bends(states_[e].size(), first, options_.bend), nullptr,
                                 {states_[e].data()});
    // an instant on a sample would change sides with it
    const double edge = 1e-3 * event.record.step();
    std::vector<int> fixed;
    for (std::size_t k = 0; k < event.switchings.size(); ++k) {
      const double room = (event.switchings[k].uncertainty - edge) / kSwitchScale;
      if (room <= 0) {
        fixed.push_back(static_cast<int>(k));
        continue;
      }
      problem_->SetParameterLowerBound(states_[e].data(), static_cast<int>(k), -room);
      problem_->SetParameterUpperBound(states_[e].data(), static_cast<int>(k), room);
    }
    if (!fixed.empty())
      problem_->SetManifold(states_[e].data(),
                            new ceres::SubsetManifold(static_cast<int>(states_[e].size()), fixed));
  }
  void add_beliefs() {
    std::vector<double> spread;
    for (std::size_t i = 0; i < setting_.axes.size(); ++i) {
      const Axis& a = setting_.axes[i];
      spread.push_back(a.spread());
      problem_->SetParameterLowerBound(z_.data(), static_cast<int>(i), std::min(0.0, a.z(a.low)));
      problem_->SetParameterUpperBound(z_.data(), static_cast<int>(i), std::max(0.0, a.z(a.high)));
    }
    problem_->AddResidualBlock(new Belief(spread, &discrepancy_), nullptr, {z_.data()});
  }
  /// Why the start cannot be evaluated.
  std::string reason() const {
    const sim::Plant plant = moved(setting_, z_.data());
    try {
      for (std::size_t e = 0; e < states_.size(); ++e) {
        auto switchings = (*setting_.events)[e].switchings;
        Drive run = costs_[e]->make_drive(plant, states_[e].data(), switchings);
        const VoltageCurve curve((*setting_.events)[e].played(), switchings);
        run.curve = &curve;
        drive(run);
      }
    } catch (const InputError& error) {
      return error.problems().front().sentence();
    }
    return "its parameters contradict each other";
  }

  void collect_events(Fit& fit) const {
    for (std::size_t e = 0; e < states_.size(); ++e) {
      const FitEvent& event = (*setting_.events)[e];
      EventFit f;
      auto switchings = event.switchings;
      Drive run = costs_[e]->make_drive(fit.plant, states_[e].data(), switchings);
      const VoltageCurve curve(event.played(), switchings);
      run.curve = &curve;
      const Response r = drive(run);
      for (const auto& s : switchings) f.state.switchings.push_back(s.time);
      const double* s = states_[e].data() + switchings.size();
      f.state.P = kStateScale[0] * s[0];
      f.state.Q = kStateScale[1] * s[1];
      f.state.angle = run.angle;
      f.state.speed = run.speed;
      if (setting_.input != InputKind::none)
        f.state.input = setting_.input == InputKind::torque ? run.torque : run.field;
      f.values = event.values();
      whiten(event, r, f);
      fit.chi2 += f.chi2;
      fit.values += f.values;
      fit.fitted += static_cast<int>(switchings.size()) + kStates;
      fit.events.push_back(std::move(f));
    }
    fit.fitted += static_cast<int>(z_.size());
  }
  static void whiten(const FitEvent& event, const Response& r, EventFit& f) {
    const auto n = static_cast<Eigen::Index>(event.channels.size());
    f.residual.resize(event.channels.size());
    Eigen::VectorXd e(n);
    for (const Output o : event.channels) f.model.push_back(r.of(o));
    for (std::size_t k = 0; k < event.record.t.size(); ++k) {
      for (Eigen::Index c = 0; c < n; ++c)
        e[c] = f.model[static_cast<std::size_t>(c)][k] -
               event.measured(event.channels[static_cast<std::size_t>(c)])[k];
      const Eigen::VectorXd w = event.whitening * e;
      if (event.compared(k)) f.chi2 += w.squaredNorm();
      for (Eigen::Index c = 0; c < n; ++c) f.residual[static_cast<std::size_t>(c)].push_back(w[c]);
    }
  }
  /// Values and their errors: the inverse of the curvature, the events' states projected out.
  void collect_parameters(Fit& fit) const {
    const auto n = static_cast<Eigen::Index>(z_.size());
    if (n == 0) return;
    Eigen::MatrixXd curvature = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t e = 0; e < costs_.size(); ++e) add_curvature(e, curvature);
    Eigen::MatrixXd with_belief = curvature;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double spread = setting_.axes[static_cast<std::size_t>(i)].spread();
      if (spread > 0) with_belief(i, i) += 1 / (spread * spread);
      fit.belief += spread > 0 ? std::pow(z_[static_cast<std::size_t>(i)] / spread, 2) : 0.0;
    }
    const Eigen::MatrixXd covariance = with_belief.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    for (Eigen::Index i = 0; i < n; ++i) {
      const Axis& a = setting_.axes[static_cast<std::size_t>(i)];
      const double z = z_[static_cast<std::size_t>(i)];
      const auto& record = parameter_record(fit.plant, a.where.block, a.where.index);
      const double error = std::sqrt(covariance(i, i));
      FittedParameter p;
      p.where = a.where;
      p.block = block_effect(fit.plant, a.where.block).name;
      p.name = record.name;
      p.unit = record.unit;
      p.start = a.start;
      p.value = a.value(z);
      p.error = a.slope(z) * error;
      constexpr double kNormal95 = 1.959963985;
      p.low = std::max(a.low, a.value(z - kNormal95 * error));
      p.high = std::min(a.high, a.value(z + kNormal95 * error));
      p.at_bound = z <= a.z(a.low) + 1e-6 || z >= a.z(a.high) - 1e-6;
      p.decided = a.spread() > 0 ? std::clamp(1 - error * error / (a.spread() * a.spread()), 0.0, 1.0) : 1.0;
      fit.parameters.push_back(p);
    }
  }
  void add_curvature(std::size_t e, Eigen::MatrixXd& curvature) const {
    using Row = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const auto rows = static_cast<Eigen::Index>((*setting_.events)[e].values());
    Row by_z(rows, static_cast<Eigen::Index>(z_.size())),
        by_state(rows, static_cast<Eigen::Index>(states_[e].size()));
    Eigen::VectorXd residual(rows);
    const double* blocks[] = {z_.data(), states_[e].data()};
    double* jacobians[] = {by_z.data(), by_state.data()};
    if (!costs_[e]->Evaluate(blocks, residual.data(), jacobians)) return;
    Eigen::MatrixXd s = by_state.transpose() * by_state;
    const auto switchings = static_cast<Eigen::Index>((*setting_.events)[e].switchings.size());
    for (Eigen::Index k = 0; k < kStates; ++k)
      s(switchings + k, switchings + k) += 1 / (kStateBelief[k] * kStateBelief[k]);
    add_bends(e, s);
    const Eigen::MatrixXd cross = by_state.transpose() * by_z;
    curvature += by_z.transpose() * by_z - cross.transpose() * s.ldlt().solve(cross);
  }

  void add_bends(std::size_t e, Eigen::MatrixXd& s) const {
    const std::size_t size = states_[e].size(), first = size - setting_.knots[e].size();
    if (first == size) return;
    const Bends bends(size, first, options_.bend);
    using Row = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Row j(size - first, size);
    std::vector<double> unused(size - first);
    const double* blocks[] = {states_[e].data()};
    double* jacobians[] = {j.data()};
    bends.Evaluate(blocks, unused.data(), jacobians);
    s += j.transpose() * j;
  }

  const Setting& setting_;
  const FitOptions& options_;
  double discrepancy_ = 1.0;
  std::vector<double> z_;
  std::vector<std::vector<double>> states_;
  std::vector<EventCost*> costs_;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace

const sim::Effect& block_effect(const sim::Plant& plant, int block) {
  if (block == 0) return *plant.machine.effect;
  const int first = plant.transformer.effect ? 2 : 1;
  if (block < first) return *plant.transformer.effect;
  return *plant.controls[static_cast<std::size_t>(block - first)].effect;
}
const sim::Parameter& parameter_record(const sim::Plant& plant, int block, int index) {
  return block_effect(plant, block).parameters[static_cast<std::size_t>(index)];
}
double& parameter_value(sim::Plant& plant, int block, int index) {
  const auto i = static_cast<std::size_t>(index);
  if (block == 0) return plant.machine.p[i];
  const int first = plant.transformer.effect ? 2 : 1;
  if (block < first) return plant.transformer.p[i];
  return plant.controls[static_cast<std::size_t>(block - first)].p[i];
}

std::vector<FreeParameter> free_parameters(const sim::Plant& plant, int block, double spread) {
  const sim::Effect& effect = block_effect(plant, block);
  const auto values = sim::block_parameters(plant)[static_cast<std::size_t>(block)];
  std::vector<double> instants;
  if (effect.instants) instants = effect.instants(effect.law.get(), values.data());
  std::vector<FreeParameter> free;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& p = effect.parameters[i];
    if (p.is_code() || values[i] == 0.0 || values[i] == p.neutral) continue;
    if (std::ranges::count(instants, values[i])) continue;
    free.push_back({block, static_cast<int>(i), spread});
  }
  return free;
}
std::vector<FreeParameter> free_parameters(const sim::Plant& plant, double spread) {
  std::vector<FreeParameter> all;
  const auto blocks = static_cast<int>(sim::block_parameters(plant).size());
  for (int b = 0; b < blocks; ++b) {
    const auto some = free_parameters(plant, b, spread);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

Fit fit(const sim::Plant& plant, const sim::Conventions& conventions, const std::vector<FitEvent>& events,
        const std::vector<FreeParameter>& free, const FitOptions& options) {
  Setting setting{&plant, &conventions, &events, {}, options.tolerance, options.input, {}};
  setting.knots.resize(events.size());
  if (options.input != InputKind::none)
    for (std::size_t e = 0; e < events.size(); ++e) setting.knots[e] = options.start[e].input.t;
  for (const auto& f : free) setting.axes.push_back(make_axis(plant, f));
  return Search(setting, options).run();
}

}  // namespace swingbank::validate
