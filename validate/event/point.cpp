#include "validate/event/point.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/config.hpp"
#include "base/describe.hpp"
#include "validate/event/detail/turns.hpp"
#include "validate/event/event.hpp"
#include "validate/event/play.hpp"
#include "validate/plant/unknown_keys.hpp"

namespace swingbank::validate::event {
namespace {

Collector read_section(Config& c, const std::string& at) {
  Collector z;
  z.R = c.require<double>(at + ".r_pu", {0.0, 10.0, "pu", "series resistance"});
  z.X = c.require<double>(at + ".x_pu", {-10.0, 10.0, "pu", "series reactance"});
  z.B = c.optional<double>(at + ".b_pu", 0.0, {-10.0, 10.0, "pu", "charging, half at either end"});
  z.ratio =
      c.optional<double>(at + ".ratio", 1.0, {0.5, 2.0, "", "voltage at the units over that at the point"});
  z.mva = c.require<double>(at + ".base_mva", {1e-3, 1e6, "MVA", "base of the values in pu"});
  return z;
}
/// Reads one section, [collector], or several, [[collector]].
std::vector<Collector> read_collector(Config& c) {
  std::vector<Collector> all;
  if (!c.has("collector")) return all;
  if (!c.is_array("collector")) return {read_section(c, "collector")};
  c.ignore("collector");  // its keys are checked below
  for (int k = 0; c.has(fmt::format("collector[{}]", k)); ++k) {
    const std::string at = fmt::format("collector[{}]", k);
    for (const std::string& key : c.keys(at))
      if (key != "r_pu" && key != "x_pu" && key != "b_pu" && key != "ratio" && key != "base_mva")
        c.problem(at + "." + key, "unknown key " + key,
                  "a collector has r_pu, x_pu, b_pu, ratio and base_mva", "remove it");
    all.push_back(read_section(c, at));
  }
  return all;
}

/// Reads the unit's part of the power. The unit under test has the remainder; its part is not used.
OtherUnit read_part(Config& c, const std::string& at) {
  OtherUnit unit;
  unit.share = c.optional<double>(at + ".share", 0.0, {1e-6, 1.0, "", "share of P and Q before the event"});
  unit.P =
      c.optional<double>(at + ".P_MW", 0.0, {-1e5, 1e5, "MW", "P before the event, in place of a share"});
  unit.Q = c.optional<double>(at + ".Q_Mvar", 0.0, {-1e5, 1e5, "Mvar", "Q before the event, with P_MW"});
  return unit;
}

void check_part(Config& c, const std::string& at) {
  const bool share = c.has(at + ".share");
  for (const char* key : {".P_MW", ".Q_Mvar"})
    if (share == c.has(at + key))
      c.problem(at,
                share ? at + " has both share and " + (key + 1) : at + " has neither share nor " + (key + 1),
                "the power of the unit is given either by share or by P_MW and Q_Mvar", "give one of them");
}

void read_model(const std::filesystem::path& file, OtherUnit& unit, Problems& problems) {
  try {
    unit.model = plant::load_plant_model(file);
  } catch (const InputError& error) {
    problems.add(error);
  }
}

/// Returns the mean power before the event [pu].
Complex mean_power(const record::Record& r, int samples) {
  Complex sum = 0;
  for (int k = 0; k < samples; ++k)
    sum += Complex(r.P[static_cast<std::size_t>(k)], r.Q[static_cast<std::size_t>(k)]);
  return sum / static_cast<double>(samples);
}

MeasuredPoint read_point(Config& c, const std::filesystem::path& tried) {
  MeasuredPoint point{.file = c.name().string(), .collector = read_collector(c), .tried = {}, .others = {}};
  Problems problems;
  bool found = false;
  double shares = 0;
  if (c.has("unit")) c.ignore("unit");  // its keys are checked below
  for (int k = 0; c.has(fmt::format("unit[{}]", k)); ++k) {
    const std::string at = fmt::format("unit[{}]", k);
    plant::refuse_unknown_keys(c, at, "[[unit]]", {"model", "share", "P_MW", "Q_Mvar"});
    const std::filesystem::path model =
        c.file(at + ".model", {.meaning = "plant file of the unit, relative to the folder of this file"});
    OtherUnit unit = read_part(c, at);
    std::error_code error;
    if (model.empty() || !std::filesystem::exists(model, error)) continue;  // reported by the config
    if (std::filesystem::equivalent(model, tried, error)) {
      found = true;
      point.tried = plant::load_plant_model(model);
      continue;
    }
    check_part(c, at);
    read_model(model, unit, problems);
    shares += unit.share;
    point.others.push_back(std::move(unit));
  }
  if (!found)
    c.problem("unit", "the plant file " + tried.string() + " is none of the units",
              "its power is the record minus the power of the other units",
              "list it as a [[unit]] with model = its path");
  if (shares >= 1 - 1e-9)
    c.problem("unit", fmt::format("the shares of the other units add up to {:g}", shares),
              "no power remains for the unit under test", "give every unit its share of the whole");
  for (const Problem& p : problems.list()) c.problem("unit", p.what + " at " + p.where, p.why, p.remedy);
  c.raise();
  return point;
}

}  // namespace

MeasuredPoint load_point(const std::filesystem::path& file, const std::filesystem::path& tried) {
  Config c(file);
  return read_point(c, tried);
}

std::string point_schema() {
  return describe_keys("Point file of Swingbank", [](Config& c) { read_point(c, {}); });
}

namespace {

record::Record behind_section(record::Record r, const Collector& z) {
  const double scale = r.base.mva / z.mva;
  const Complex Z(z.R * scale, z.X * scale), half(0, z.B / scale / 2);
  for (std::size_t k = 0; k < r.t.size(); ++k) {
    const Complex outer = std::polar(r.V[k], r.theta[k]);
    const Complex through = std::conj(Complex(r.P[k], r.Q[k]) / outer) + half * outer;
    const Complex inner = outer + Z * through, V = inner * z.ratio;
    const Complex S = V * std::conj((through + half * inner) / z.ratio);
    r.V[k] = std::abs(V);
    r.theta[k] += std::arg(V / outer);
    r.P[k] = S.real();
    r.Q[k] = S.imag();
  }
  r.notes.push_back(
      fmt::format("V, angle, P and Q were transformed to the units' side of the collector of {:g} + j{:g} "
                  "pu on {:g} MVA.",
                  z.R, z.X, z.mva));
  return r;
}

/// Returns the series connection of two two-ports; `first` is at the plant.
sim::plant::TwoPort in_a_row(const sim::plant::TwoPort& first, const sim::plant::TwoPort& then) {
  return {then.a * first.a + then.b * first.c, then.a * first.b + then.b * first.d,
          then.c * first.a + then.d * first.c, then.c * first.b + then.d * first.d};
}
/// Returns the two-port from the units' side of a section to the point [pu on `mva`], the inverse of
/// behind_section().
sim::plant::TwoPort across(const Collector& z, double mva) {
  const double scale = mva / z.mva;
  const Complex Z(z.R * scale, z.X * scale), half(0, z.B / scale / 2);
  return in_a_row({1 / z.ratio, 0, 0, z.ratio},
                  in_a_row(in_a_row({1, 0, -half, 1}, {1, -Z, 0, 1}), {1, 0, -half, 1}));
}
/// Returns whether a control of the plant measures at another bus.
bool looks_far(const sim::plant::Plant& plant) {
  return std::ranges::any_of(plant.controls,
                             [](const auto& block) { return block.effect->elsewhere.bus >= 0; });
}

}  // namespace

record::Record behind_collector(record::Record r, const std::vector<Collector>& collector) {
  for (const Collector& z : collector) r = behind_section(std::move(r), z);
  return r;
}

sim::plant::TwoPort to_point(const std::vector<Collector>& collector, double mva, double share) {
  sim::plant::TwoPort all{1, 0, 0, 1 / share};
  for (std::size_t k = collector.size(); k-- > 0;) all = in_a_row(all, across(collector[k], mva));
  return all;
}

sim::plant::Plant at_point(const MeasuredPoint& point) {
  sim::plant::Plant plant = point.tried.plant;
  if (!looks_far(plant)) return plant;
  double share = 1;
  for (const OtherUnit& unit : point.others) {
    if (!(unit.share > 0))
      throw InputError({"no share of " + unit.model.name, point.file,
                        "the control of " + point.tried.name +
                            " measures at the common point, where the signals depend on all units",
                        "give share instead of P_MW and Q_Mvar"});
    share -= unit.share;
  }
  plant.beyond = to_point(point.collector, plant.mva, share);
  return plant;
}

MeasuredPoint load_point(const std::filesystem::path& file, plant::PlantModel& tried) {
  MeasuredPoint point = load_point(file, tried.origin);
  tried.plant.beyond = at_point(point).beyond;
  return point;
}

namespace {

/// Unit behind the point, with the record prepared for its model.
struct PreparedUnit {
  sim::plant::PlantUnderTest tested;
  Complex start;  ///< P and Q before the event [pu on the record's base]
  FitEvent event;
  [[nodiscard]] playin::Response response(const EventState& state, const Playing& how) const {
    return play(tested, event, state, {}, how);
  }
};

/// Returns the rating of all machines behind the point [MVA].
double all_mva(const MeasuredPoint& point) {
  double mva = point.tried.plant.mva;
  for (const OtherUnit& unit : point.others) mva += unit.model.plant.mva;
  return mva;
}

FitEventOptions of_all(double mva) {
  FitEventOptions options;
  options.measured_states = false;
  options.mva = mva;
  return options;
}

/// Prepares the event of one unit. `start`: its P + jQ before the event [pu on the record's base]; `seen`:
/// record with the power of all units; `mva`: rating of all units [MVA].
PreparedUnit prepare_unit(const plant::PlantModel& model, const record::Record& seen, double mva,
                          Complex start) {
  FitEventOptions options = of_all(mva);
  options.start = start;
  PreparedUnit unit{model.under_test(), start, std::move(prepare_events(model, {seen}, options).front())};
  unit.event.keep_curve();
  return unit;
}

/// Returns measured P and Q minus the simulated P and Q of all units [pu], until 0.5 s after the last
/// switching.
Eigen::VectorXd left_over(const std::vector<PreparedUnit>& units, const record::Record& whole,
                          const EventState& state) {
  constexpr double kAfter = 0.5;  // [s]; later, errors of the models exceed those of the switching times
  const FitEvent& event = units[0].event;
  const Playing how{.tolerance = 1e-7, .hasty = false, .until = event.switchings.back().time + kAfter};
  std::vector<playin::Response> responses;
  for (const PreparedUnit& unit : units) responses.push_back(unit.response(state, how));
  Eigen::VectorXd left = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(whole.t.size()));
  for (std::size_t k = 0; k < whole.t.size() && whole.t[k] <= how.until; ++k) {
    if (!event.compared(k)) continue;
    double P = whole.P[k], Q = whole.Q[k];
    for (const playin::Response& r : responses)
      P -= r.of(playin::Output::P)[k], Q -= r.of(playin::Output::Q)[k];
    left.segment<2>(2 * static_cast<Eigen::Index>(k)) = Eigen::Vector2d(P, Q);
  }
  return left;
}

/// Returns the least-squares step for the residual `left`, with `at` + step between -1 and 1. Components that
/// would exceed a bound are clamped there, and the others are solved again.
Eigen::VectorXd bounded_step(const Eigen::MatrixXd& jacobian, Eigen::VectorXd left,
                             const Eigen::VectorXd& at) {
  Eigen::VectorXd step = Eigen::VectorXd::Zero(at.size());
  std::vector<Eigen::Index> free(static_cast<std::size_t>(at.size()));
  std::iota(free.begin(), free.end(), 0);
  while (!free.empty()) {
    const Eigen::VectorXd solved = jacobian(Eigen::all, free).colPivHouseholderQr().solve(-left);
    std::vector<Eigen::Index> inside;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Eigen::Index k = free[i];
      const double end = at[k] + solved[static_cast<Eigen::Index>(i)];
      step[k] = std::clamp(end, -1.0, 1.0) - at[k];
      if (std::abs(end) <= 1)
        inside.push_back(k);
      else
        left += jacobian.col(k) * step[k];
    }
    if (inside.size() == free.size()) break;
    free = inside;
  }
  return step;
}

/// Fits the switching times within their uncertainties, and the phase jumps of an integrated angle, to the
/// power of all units (Gauss-Newton). An error of half an interval at 60 samples/s would cause an error of
/// several per cent of the units' power during a fault.
EventState fit_switching_times(const std::vector<PreparedUnit>& units, const record::Record& whole) {
  constexpr int kPointRounds = 8;
  constexpr double kAside = 0.02,
                   kPointSettled = 1e-4;  // fraction of a time's uncertainty, or of kFarthestTurn
  const auto& switchings = units[0].event.switchings;
  const auto n = static_cast<Eigen::Index>(switchings.size() * (units[0].event.turns() ? 2 : 1));
  const auto state_at = [&](const Eigen::VectorXd& at) {
    EventState state;
    for (std::size_t k = 0; k < switchings.size(); ++k)
      state.switchings.push_back(switchings[k].time +
                                 switchings[k].uncertainty * at[static_cast<Eigen::Index>(k)]);
    for (auto k = static_cast<Eigen::Index>(switchings.size()); k < n; ++k)
      state.turns.push_back(kFarthestTurn * at[k]);
    return state;
  };
  const auto left_at = [&](const Eigen::VectorXd& at) { return left_over(units, whole, state_at(at)); };
  Eigen::VectorXd at = Eigen::VectorXd::Zero(n), left = left_at(at);
  for (int round = 0; round < kPointRounds; ++round) {
    Eigen::MatrixXd jacobian(left.size(), n);
    for (Eigen::Index k = 0; k < n; ++k) {
      const double aside = at[k] > 0 ? -kAside : kAside;
      Eigen::VectorXd beside = at;
      beside[k] += aside;
      jacobian.col(k) = (left_at(beside) - left) / aside;
    }
    Eigen::VectorXd step = bounded_step(jacobian, left, at);
    Eigen::VectorXd next = left_at(at + step);
    for (int half = 0; half < 5 && next.squaredNorm() > left.squaredNorm(); ++half)
      next = left_at(at + (step *= 0.5));
    if (next.squaredNorm() > left.squaredNorm()) break;
    at += step, left = next;
    if (step.cwiseAbs().maxCoeff() < kPointSettled) break;
  }
  return state_at(at);
}

/// Returns the models of the other units, then of the tested unit. Their controls that measure at another bus
/// are set to measure at the point, except those of another unit whose power is given by P and Q.
std::vector<plant::PlantModel> models_at(const MeasuredPoint& point) {
  std::vector<plant::PlantModel> models;
  for (const OtherUnit& unit : point.others) {
    models.push_back(unit.model);
    if (unit.share > 0 && looks_far(unit.model.plant))
      models.back().plant.beyond = to_point(point.collector, unit.model.plant.mva, unit.share);
  }
  models.push_back(point.tried);
  models.back().plant = at_point(point);
  return models;
}

}  // namespace

record::Record of_tried_unit(const MeasuredPoint& point, record::Record record) {
  record::require_angle(record);
  if (record.P.size() != record.t.size() || record.Q.size() != record.t.size())
    throw InputError({"no P and Q", record.name, "the power at the common point is divided among its units",
                      "record both at the common point"});
  record = behind_collector(std::move(record), point.collector);
  if (point.others.empty()) return record;
  record::Record seen = record;
  for (auto* channel :
       {&seen.speed, &seen.Efd, &seen.Ifd, &seen.Vs, &seen.Vref, &seen.Pm, &seen.Pref, &seen.gate})
    channel->clear();  // these channels are those of the tested unit
  const double mva = all_mva(point);
  const Complex whole = mean_power(seen, samples_before_event(seen, of_all(mva)));
  const std::vector<plant::PlantModel> models =
      models_at(point);  // must outlive the units, which refer to them
  std::vector<PreparedUnit> units;
  Complex others = 0;
  for (std::size_t k = 0; k < point.others.size(); ++k) {
    const OtherUnit& unit = point.others[k];
    const Complex start = unit.share > 0 ? unit.share * whole : Complex(unit.P, unit.Q) / record.base.mva;
    units.push_back(prepare_unit(models[k], seen, mva, start));
    others += start;
  }
  units.push_back(prepare_unit(models.back(), seen, mva, whole - others));
  EventState state;
  if (!units[0].event.switchings.empty()) state = fit_switching_times(units, record);
  for (std::size_t u = 0; u < point.others.size(); ++u) {
    const playin::Response r = units[u].response(state, {.tolerance = 1e-8, .hasty = false});
    for (std::size_t k = 0; k < record.t.size(); ++k) {
      record.P[k] -= r.of(playin::Output::P)[k];
      record.Q[k] -= r.of(playin::Output::Q)[k];
    }
    const Complex start = units[u].start * record.base.mva;
    record.notes.push_back(fmt::format(
        "The simulated power of {} was subtracted; it was {:.4g} MW and {:.4g} Mvar before the event.",
        point.others[u].model.name, start.real(), start.imag()));
  }
  return record;
}

}  // namespace swingbank::validate::event
