#include "sim/network/consistency.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numeric>

#include "sim/network/admittance.hpp"
#include "sim/network/connectivity.hpp"
#include "sim/network/powerflow.hpp"
#include "sim/network/tie.hpp"

namespace swingbank::sim::network {
namespace {

const Bus& at(const Network& n, int bus) { return n.buses[static_cast<std::size_t>(bus)]; }
std::string pu(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

}  // namespace

void settle_isolated(Network& n) {
  const auto isolated = [&](int bus) { return at(n, bus).type == BusType::isolated; };
  std::erase_if(n.loads, [&](const Load& l) { return isolated(l.bus); });
  std::erase_if(n.shunts, [&](const Shunt& s) { return isolated(s.bus); });
  std::erase_if(n.switched, [&](const SwitchedShunt& s) { return isolated(s.bus) || isolated(s.regulated); });
  for (Branch& b : n.branches)
    if (isolated(b.from) || isolated(b.to)) b.in_service = false;
  for (Generator& g : n.generators)
    if (isolated(g.bus)) g.in_service = false;
}

void isolate_idle_stars(Network& n, const std::set<int>& stars) {
  for (const int star : stars)
    if (std::ranges::none_of(n.branches, [&](const Branch& b) { return b.to == star && b.in_service; }))
      n.buses[static_cast<std::size_t>(star)].type = BusType::isolated;
}

void settle_stars(Network& n, const std::set<int>& stars) {
  const auto y = bus_admittance(n);
  for (const int star : stars) {
    Bus& bus = n.buses[static_cast<std::size_t>(star)];
    if (bus.type == BusType::isolated) continue;
    Complex others{}, own{};
    for (decltype(y)::InnerIterator e(y, star); e; ++e) {
      const Bus& other = at(n, static_cast<int>(e.row()));
      // The iterator runs over the star's column, but the star's row is needed. Row and column differ by the
      // phase shifts.
      const Complex value = y.coeff(star, static_cast<int>(e.row()));
      (e.row() == star ? own : others) += e.row() == star ? value : value * std::polar(other.vm, other.va);
    }
    if (own == Complex{}) continue;
    bus.vm = std::abs(others / own);
    bus.va = std::arg(-others / own);
  }
}

namespace {

std::string unit_text(const Network& n, const Generator& g) {
  return "'" + g.id + "' at bus " + std::to_string(at(n, g.bus).number);
}

/// Sums the imbalances of buses that are joined by ties and assigns the sum to each of them. A file's
/// voltages have five digits, too few for the current of a tie.
std::vector<Complex> pooled(const Network& n, const std::vector<Complex>& left, std::vector<int>& pool) {
  pool.resize(left.size());
  std::iota(pool.begin(), pool.end(), 0);
  const auto root = [&](int i) {
    while (pool[static_cast<std::size_t>(i)] != i) i = pool[static_cast<std::size_t>(i)];
    return i;
  };
  for (const Branch& b : n.branches)
    if (b.in_service && is_tie(b)) pool[static_cast<std::size_t>(root(b.from))] = root(b.to);
  std::vector<Complex> sum(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    pool[i] = root(static_cast<int>(i));
    sum[static_cast<std::size_t>(pool[i])] += left[i];
  }
  std::vector<Complex> all(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) all[i] = sum[static_cast<std::size_t>(pool[i])];
  return all;
}

constexpr double kSameImbalance = 1e-6;  // [pu] smaller differences of two imbalances are not significant

bool is_of(const Duplicate& d, Duplicate::Kind, const Network& n, const Branch& b) {
  if (d.kind != Duplicate::Kind::branch || b.circuit != d.id) return false;
  const Bus &from = at(n, b.from), &to = at(n, b.to);
  if (d.buses.size() > 2) return std::ranges::equal(to.star_of, d.buses);
  return (from.number == d.buses[0] && to.number == d.buses[1]) ||
         (from.number == d.buses[1] && to.number == d.buses[0]);
}
/// Whether a load, shunt or generator is the duplicate `d`.
template <class Equipment>
bool is_of(const Duplicate& d, Duplicate::Kind kind, const Network& n, const Equipment& e) {
  return d.kind == kind && e.id == d.id && at(n, e.bus).number == d.buses[0];
}
/// Removes the equipment for which `of` is true.
template <class Of>
void erase_equipment(Network& n, const Of& of) {
  using Kind = Duplicate::Kind;
  std::erase_if(n.loads, [&](const Load& l) { return of(Kind::load, l); });
  std::erase_if(n.shunts, [&](const Shunt& s) { return of(Kind::shunt, s); });
  std::erase_if(n.switched, [&](const SwitchedShunt& s) { return of(Kind::shunt, s); });
  for (Generator& g : n.generators)
    if (of(Kind::generator, g)) g.in_service = false;
  for (Branch& b : n.branches)
    if (of(Kind::branch, b)) b.in_service = false;
}

/// Power balance at the file's voltages as a linear function of the kept duplicates: P and Q at load buses, P
/// at generator buses. Buses with devices are excluded; buses joined by ties count as one.
struct FileBalance {
  Eigen::MatrixXd drawn;   ///< a column for each duplicate: its power [pu]
  Eigen::VectorXd others;  ///< imbalance without the duplicates [pu]

  FileBalance(const Network& n, const std::vector<Duplicate>& duplicates,
              const std::vector<Device>& devices) {
    std::vector<int> pool;
    const std::vector<Complex> left = pooled(n, imbalance_of_file(n), pool);
    std::vector<BusType> kind(left.size(), BusType::load);  // per group of joined buses: its highest bus type
    for (std::size_t i = 0; i < left.size(); ++i) {
      BusType& most = kind[static_cast<std::size_t>(pool[i])];
      most = std::max(most, n.buses[i].type);
    }
    for (const Device& d : devices)
      for (const int bus : d.buses)
        if (bus >= 0) kind[static_cast<std::size_t>(pool[static_cast<std::size_t>(bus)])] = BusType::slack;
    std::vector<std::vector<Complex>> columns;
    for (const Duplicate& d : duplicates) {
      Network alone = n;
      erase_equipment(alone, [&]<class E>(Duplicate::Kind k, const E& e) { return !is_of(d, k, n, e); });
      columns.push_back(pooled(n, imbalance_of_file(alone), pool));
    }
    std::vector<Eigen::VectorXd> rows;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const auto reaches = [&](const std::vector<Complex>& column) {
        return std::abs(column[i]) > kSameImbalance;
      };
      if (pool[i] != static_cast<int>(i) || kind[i] > BusType::generator ||
          std::ranges::none_of(columns, reaches))
        continue;
      const bool load = kind[i] == BusType::load;
      for (const bool reactive : load ? std::vector{false, true} : std::vector{false}) {
        Eigen::VectorXd& row = rows.emplace_back(static_cast<Eigen::Index>(columns.size()) + 1);
        const auto part = [&](Complex c) { return reactive ? c.imag() : c.real(); };
        for (std::size_t k = 0; k < columns.size(); ++k)
          row[static_cast<Eigen::Index>(k)] = part(columns[k][i]);
        row[row.size() - 1] = part(left[i]);
      }
    }
    drawn.resize(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
    others.resize(drawn.rows());
    for (Eigen::Index i = 0; i < drawn.rows(); ++i) {
      const Eigen::VectorXd& row = rows[static_cast<std::size_t>(i)];
      drawn.row(i) = row.head(drawn.cols());
      others[i] = row[drawn.cols()] - drawn.row(i).sum();
    }
  }
  /// Returns the imbalance [pu] at the buses of duplicate k, with and without the duplicate. `kept`: 1 for
  /// each kept duplicate.
  [[nodiscard]] std::pair<double, double> with_and_without(Eigen::Index k, Eigen::VectorXd kept) const {
    const auto size = [&](double of_it) {
      kept[k] = of_it;
      return ((others + drawn * kept).array() * (drawn.col(k).array().abs() > kSameImbalance).cast<double>())
          .matrix()
          .norm();
    };
    return {size(1.0), size(0.0)};
  }
  /// Returns 1 for each duplicate that the file's voltages confirm. The start is a rounded least-squares
  /// solution. Then the decision on each duplicate is repeated in turn until none changes (at most 20
  /// rounds).
  [[nodiscard]] Eigen::VectorXd shown() const {
    Eigen::VectorXd kept = Eigen::VectorXd::Ones(drawn.cols());
    if (drawn.rows() > 0) kept = drawn.completeOrthogonalDecomposition().solve(-others);
    kept = kept.unaryExpr([](double share) { return share > 0.5 ? 1.0 : 0.0; });
    constexpr int rounds = 20;
    bool changed = true;
    for (int round = 0; changed && round < rounds; ++round) {
      changed = false;
      for (Eigen::Index k = 0; k < kept.size(); ++k) {
        const auto [with, without] = with_and_without(k, kept);
        const double keeps = with < without + kSameImbalance ? 1.0 : 0.0;
        changed = changed || keeps != kept[k];
        kept[k] = keeps;
      }
    }
    return kept;
  }
};

std::string kept_as(const Duplicate& d) { return d.text + " as '" + d.id + "'"; }

std::string mva(const Network& n, double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g MVA", value * n.base_mva);
  return text;
}

/// Decides by the file's voltages which generators at load buses are in service.
void settle_load_buses(Network& n, const std::function<std::string(std::size_t)>& where) {
  const auto at_load_bus = [&](const Generator& g) {
    return g.in_service && at(n, g.bus).type == BusType::load;
  };
  if (std::ranges::none_of(n.generators, at_load_bus)) return;
  std::vector<int> pool;
  const std::vector<Complex> left = pooled(n, imbalance_of_file(n), pool);
  std::map<int, Complex> given;
  for (const Generator& g : n.generators)
    if (at_load_bus(g)) given[g.bus] += Complex(g.p, g.q);
  for (std::size_t i = 0; i < n.generators.size(); ++i) {
    Generator& g = n.generators[i];
    if (!at_load_bus(g)) continue;
    const Complex with = left[static_cast<std::size_t>(g.bus)], without = with + given[g.bus];
    const bool shown = std::abs(with) < std::abs(without);
    n.remark(
        shown ? "generators at a bus of type 1 deliver their P and Q, because the file's voltages confirm it"
              : "generators at a bus of type 1 are out of service, as in PSS/E",
        unit_text(n, g) + " (" + where(i) + ")");
    if (!shown) g.in_service = false;
  }
}

/// A generator whose regulated bus is out of service regulates its own bus.
void regulate_own_bus(Network& n, Generator& g, const std::string& place) {
  if (g.regulated < 0 || at(n, g.regulated).type != BusType::isolated) return;
  n.remark("generators whose regulated bus is out of service regulate their own bus, at the file's voltage",
           place);
  g.regulated = -1;
  g.vset = at(n, g.bus).vm;
}

}  // namespace

void settle_duplicates(Network& n, const std::vector<Duplicate>& duplicates, bool by_voltages,
                       const std::vector<Device>& devices) {
  if (duplicates.empty()) return;
  if (!by_voltages) {
    for (const Duplicate& d : duplicates)
      n.remark("duplicate equipment is kept under a new id (--repeated keep)", kept_as(d));
    return;
  }
  const FileBalance balance(n, duplicates, devices);
  const Eigen::VectorXd kept = balance.shown();
  for (std::size_t i = 0; i < duplicates.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const auto [with, without] = balance.with_and_without(k, kept);
    const std::string numbers =
        ": the imbalance of its buses is " + mva(n, with) + " with it, " + mva(n, without) + " without it";
    if (std::abs(with - without) < kSameImbalance)
      n.remark("duplicate equipment is kept under a new id; the file's voltages do not depend on it",
               kept_as(duplicates[i]));
    else if (kept[k] > 0.0)
      n.remark("duplicate equipment is kept under a new id, because the file's voltages confirm it",
               kept_as(duplicates[i]) + numbers);
    else
      n.remark("duplicate equipment is ignored, because the file's voltages contradict it",
               duplicates[i].text + numbers);
  }
  erase_equipment(n, [&]<class E>(Duplicate::Kind kind, const E& e) {
    for (std::size_t i = 0; i < duplicates.size(); ++i)
      if (kept[static_cast<Eigen::Index>(i)] == 0.0 && is_of(duplicates[i], kind, n, e)) return true;
    return false;
  });
}

void settle_generators(Network& n, const std::function<std::string(std::size_t)>& where) {
  settle_load_buses(n, where);
  std::map<int, const Generator*> first;
  for (std::size_t i = 0; i < n.generators.size(); ++i) {
    Generator& g = n.generators[i];
    if (!g.in_service || at(n, g.bus).type == BusType::load) {
      g.regulated = -1;  // it does not regulate a voltage
      continue;
    }
    const std::string place = unit_text(n, g) + " (" + where(i) + ")";
    if (g.regulated == g.bus) g.regulated = -1;
    regulate_own_bus(n, g, place);
    if (g.q_min > g.q_max) {
      n.remark("reactive limits with QB above QT are ignored", place);
      g.q_min = -99.99;
      g.q_max = 99.99;
    }
    const Generator& other = *first.emplace(g.bus, &g).first->second;
    if (other.vset == g.vset && other.regulated == g.regulated) continue;
    n.remark("generators of one bus with different set-points take that of the first",
             place + ": " + pu(g.vset) + " pu becomes " + pu(other.vset) + " pu");
    g.vset = other.vset;
    g.regulated = other.regulated;
  }
}

void settle_islands(Network& n) {
  std::vector<double> supply(n.buses.size());
  for (const Generator& g : n.generators)
    if (g.in_service) supply[static_cast<std::size_t>(g.bus)] += g.mva;
  for (std::size_t i = 0; i < n.buses.size(); ++i)
    if (n.buses[i].type == BusType::slack && supply[i] == 0.0) {
      n.remark("slack buses without a generator in service are load buses", n.bus_text(static_cast<int>(i)));
      n.buses[i].type = BusType::load;
    }
  const std::vector<int> island = islands(n);
  std::map<int, std::vector<int>> members;
  for (std::size_t i = 0; i < island.size(); ++i)
    if (island[i] >= 0) members[island[i]].push_back(static_cast<int>(i));
  for (const auto& [number, buses] : members) {
    if (std::ranges::any_of(buses, [&](int b) { return at(n, b).type == BusType::slack; })) continue;
    const auto size = [&](int b) {
      return at(n, b).type == BusType::generator ? supply[static_cast<std::size_t>(b)] : 0.0;
    };
    const int largest = *std::ranges::max_element(buses, {}, size);
    if (size(largest) > 0.0) {
      n.buses[static_cast<std::size_t>(largest)].type = BusType::slack;
      n.remark("islands without a slack bus get one at their largest generator",
               "bus " + std::to_string(at(n, largest).number) + " of " + bus_list(n, buses));
      continue;
    }
    for (const int b : buses) n.buses[static_cast<std::size_t>(b)].type = BusType::isolated;
    n.remark("islands without a generator at a bus of type 2 or 3 are out of service", bus_list(n, buses));
  }
  settle_isolated(n);
  for (Generator& g : n.generators)
    if (g.in_service) regulate_own_bus(n, g, unit_text(n, g));
}

namespace {

/// Returns the largest imbalance [pu] at a load bus without devices, and the bus.
std::pair<double, int> worst_elsewhere(const Network& n, const std::vector<Complex>& left,
                                       const std::vector<int>& pool, const std::map<int, int>& devices) {
  std::pair<double, int> worst{0.0, -1};
  for (std::size_t i = 0; i < left.size(); ++i)
    if (n.buses[i].type == BusType::load && !devices.contains(pool[i]) && std::abs(left[i]) > worst.first)
      worst = {std::abs(left[i]), static_cast<int>(i)};
  return worst;
}

std::string megawatts(double p, const Network& n) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f MW", p * n.base_mva);
  return text;
}

/// Returns the scheduled consumption of the devices at each bus [pu]; NaN: unknown.
std::map<int, double> schedules(const std::vector<Device>& devices) {
  std::map<int, double> at_bus;
  for (const Device& d : devices)
    for (std::size_t i = 0; i < d.buses.size(); ++i)
      at_bus[d.buses[i]] +=
          i < d.scheduled.size() ? d.scheduled[i] : std::numeric_limits<double>::quiet_NaN();
  return at_bus;
}

std::string power_text(Complex s, double base) {
  char text[80];
  std::snprintf(text, sizeof text, "P = %.2f MW, Q = %.2f Mvar", s.real() * base, s.imag() * base);
  return text;
}

}  // namespace

void replace_devices(Network& n, const std::vector<Device>& devices, DeviceReplacement how,
                     Problems& problems) {
  std::map<int, std::string> at_bus;
  std::string where;
  for (const Device& d : devices)
    for (const int bus : d.buses) {
      if (bus < 0 || at(n, bus).type == BusType::isolated) continue;
      std::string& names = at_bus[bus];
      names += (names.empty() ? "" : ", ") + d.name;
      if (where.empty()) where = d.where;
    }
  if (at_bus.empty() || !problems.empty()) return;
  if (how == DeviceReplacement::none) {
    for (const auto& [b, names] : at_bus)
      n.remark("equipment without a model is ignored (--devices none)",
               names + " at bus " + std::to_string(at(n, b).number));
    return;
  }
  std::vector<int> pool;
  const std::vector<Complex> left = pooled(n, imbalance_of_file(n), pool);
  std::map<int, int> sharing;  // number of device buses in each group of joined buses
  for (const auto& [b, names] : at_bus) ++sharing[pool[static_cast<std::size_t>(b)]];
  const std::map<int, double> schedule = schedules(devices);
  constexpr double most = 0.05;  // [pu], ten times the rounding error of a solved case with five digits
  const auto [worst, bus] = worst_elsewhere(n, left, pool, sharing);
  const bool finite = std::ranges::all_of(
      left, [](const Complex& c) { return std::isfinite(c.real()) && std::isfinite(c.imag()); });
  if (!finite || (worst > most && how == DeviceReplacement::checked)) {
    problems.add(
        at_bus.begin()->second + " without a model", where,
        "its power is computed from the file's voltages, but they do not satisfy the power flow: the "
        "mismatch is " +
            pu(worst * n.base_mva) + " MVA" + (bus < 0 ? std::string() : " at " + n.bus_text(bus)),
        "solve the case before saving it; or use --devices file (accept the mismatch) or --devices none "
        "(ignore the equipment)");
    return;
  }
  for (const auto& [bus_of, names] : at_bus) {
    const int b = bus_of;  // clang 14 cannot capture a structured binding
    const auto i = static_cast<std::size_t>(b);
    const Complex draws = -left[i] / static_cast<double>(sharing[pool[i]]);
    std::string id = "~";
    while (std::ranges::any_of(n.loads, [&](const Load& l) { return l.bus == b && l.id == id; })) id += "~";
    const Bus& of = at(n, b);
    n.loads.push_back({b, id, draws, {}, {}, of.area, of.zone, of.owner, LoadKind::device});
    n.remark("equipment without a model draws constant P and Q, computed from the file's voltages",
             names + " at bus " + std::to_string(of.number) + ": " + power_text(draws, n.base_mva));
    constexpr double far = 0.1;  // fraction of the schedule, in addition to the file's rounding
    if (const double scheduled = schedule.at(b);
        sharing[pool[i]] == 1 && std::abs(draws.real() - scheduled) > most + far * std::abs(scheduled))
      n.remark(
          "equipment without a model draws a power far from its schedule: solve the case, or correct "
          "the schedule or the voltages",
          names + " at bus " + std::to_string(of.number) + ": " + megawatts(draws.real(), n) +
              " by the file's voltages, " + megawatts(scheduled, n) + " scheduled");
  }
}

void check_finite(const Network& n, const std::string& file, Problems& problems) {
  const auto report = [&](const std::string& what, int bus, std::initializer_list<double> values) {
    if (std::ranges::all_of(values, [](double v) { return std::isfinite(v); })) return;
    problems.add(what + " at " + n.bus_text(bus) + " has a value that is not finite", file,
                 "a value is extremely large, or its base extremely small", "correct the value or the base");
  };
  for (const Load& l : n.loads)
    report("load '" + l.id + "'", l.bus,
           {l.power.real(), l.power.imag(), l.current.real(), l.current.imag(), l.admittance.real(),
            l.admittance.imag()});
  for (const Shunt& s : n.shunts)
    report("shunt '" + s.id + "'", s.bus, {s.admittance.real(), s.admittance.imag()});
  for (const Branch& b : n.branches)
    report("the branch with circuit '" + b.circuit + "'", b.from,
           {b.r, b.x, b.b, b.tap, b.shift, b.shunt_from.real(), b.shunt_from.imag(), b.shunt_to.real(),
            b.shunt_to.imag()});
  for (const Generator& g : n.generators)
    report("generator '" + g.id + "'", g.bus, {g.p, g.q, g.vset, g.mva, g.zr, g.zx, g.q_min, g.q_max});
}

}  // namespace swingbank::sim::network
