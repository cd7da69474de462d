// Reader of the branches and transformers of an .epc. The sections of a line are in series, without buses
// between them. A transformer's impedances are per unit of tbase and of the windings' nominal voltages. In
// per unit of the bus voltages, a winding is an ideal ratio: the winding's nominal voltage divided by that of
// its bus, times the winding's tap.
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/formats/detail/epc_reader.hpp"

namespace swingbank::sim::formats::epc {

using psse::Fields;
using psse::shortest;

namespace {

/// Columns of a transformer's record after the ':', with its lines joined.
enum Column : std::size_t {
  kInternal = 6,
  kTertiary = 9,
  kTbase = 14,
  kPsR = 15,
  kPtR = 17,
  kTsR = 19,
  kVnomP = 21,
  kVnomS = 22,
  kVnomT = 23,
  kAngleP = 24,
  kGmag = 25,
  kTap = 37,
  kFixedP = 38,
  kFixedS = 39,
  kFixedT = 40,
  kOhms = 65,
  kTbasePt = 66,
  kTbaseTs = 67,
  kAngleS = 68,
  kAngleT = 69
};

std::string ends_text(int from, int to) { return std::to_string(from) + "-" + std::to_string(to); }

double angle(Fields& f, std::size_t column, const char* name) {
  return static_cast<double>(f.number(column, name, 0.0L) / psse::kDegrees);
}

/// Returns the winding's nominal voltage divided by that of its bus, or 1 if either is missing.
long double nominal(Fields& f, std::size_t column, const char* name, double kv) {
  const long double v = f.number(column, name, 0.0L);
  return v > 0 && kv > 0 ? v / static_cast<long double>(kv) : 1.0L;
}

long double ratio(long double turns, const char* winding, const Fields& f, Problems& problems) {
  if (turns > 0) return turns;
  problems.add("a ratio of " + shortest(static_cast<double>(turns)) + " of the " + winding + " winding",
               f.where(), "a turns ratio must be positive", "correct its taps");
  return 1.0L;
}
long double primary(Fields& f, double kv, Problems& problems) {
  const long double tap = f.number(kTap, "tapp", 1.0L) + f.number(kFixedP, "tapfp", 1.0L) - 1.0L;
  return ratio(nominal(f, kVnomP, "vnomp", kv) * tap, "primary", f, problems);
}
/// Returns the ratio of the secondary or tertiary winding. PSLF writes 0 for a missing fixed tap.
long double other(Fields& f, std::size_t volt, std::size_t fixed, double kv, const char* winding,
                  Problems& problems) {
  const long double tap = f.number(fixed, "fixed tap", 1.0L);
  return ratio(nominal(f, volt, "nominal voltage", kv) * (tap == 0 ? 1.0L : tap), winding, f, problems);
}

/// Returns the impedance of one pair of windings, with R and X at `column` [pu on the system base].
Impedance pair_impedance(Fields& f, std::size_t column, const char* r, const char* x, long double mva,
                         long double base, Problems& problems) {
  const Impedance z{f.number(column, r, 0.0L), f.number(column + 1, x, 0.0L)};
  if (mva > 0) return z * (base / mva);
  if (z != Impedance{})
    problems.add("a transformer on " + shortest(static_cast<double>(mva)) + " MVA", f.where(),
                 "its impedance refers to tbase", "give a base > 0 MVA");
  return z;
}

/// A pi section as a two-port; then() combines it with the following section in series.
struct TwoPort {
  Complex y11, y12, y22;
  static TwoPort of(const network::Branch& b) {
    const Complex y = 1.0 / Complex(b.r, b.x), half(0.0, b.b / 2);
    return {y + half + b.shunt_from, -y, y + half + b.shunt_to};
  }
  [[nodiscard]] TwoPort then(const TwoPort& next) const {
    const Complex middle = y22 + next.y11;
    return {y11 - y12 * y12 / middle, -y12 * next.y12 / middle, next.y22 - next.y12 * next.y12 / middle};
  }
};

}  // namespace

void EpcReader::branch(const Row& row) {
  Fields of(row.of, file_, problems_), f(row.says, file_, problems_);
  network::Branch b{};
  const int from = of.integer(0, "from bus"), to = of.integer(3, "to bus");
  b.from = find_bus(from, of);
  b.to = find_bus(to, of);
  const int section = std::max(of.integer(7, "se", 1), 1);
  const auto value = [&](std::size_t i, const char* name) { return static_cast<double>(f.number(i, name)); };
  b.in_service = status(f);
  b.r = value(1, "resist");
  b.x = value(2, "react");
  b.b = value(3, "charge");
  const std::string ends = "branch " + ends_text(std::min(from, to), std::max(from, to)) + " circuit",
                    part = section > 1 ? " section " + std::to_string(section) : "";
  const auto circuit =
      identities_.id({network::Duplicate::Kind::branch, {from, to}}, ends, id_of(of, 6), part, of);
  if (!circuit) return;
  b.circuit = *circuit;
  const std::string name = ends + " '" + b.circuit + "'" + part;
  const std::size_t second = row.starts.empty() ? 10 : row.starts[0];  // ar zone trangi tap_f tap_t ... ohm
  for (const std::size_t i : {second + 3, second + 4})
    if (const long double tap = f.number(i, "tap", 0.0L); tap != 0 && tap != 1)
      problems_.add("a transformer inside " + name, f.where(), "tap_f or tap_t is neither 0 nor 1",
                    "enter it as a transformer");
  if (f.integer(second + 30, "ohm", 0) != 0)
    problems_.add(name + " in ohms", f.where(), "only impedances per unit are read",
                  "save the case per unit");
  check_ends("a branch", b, f);
  if (b.from < 0 || b.to < 0) return;
  raise_impedance(b, f);
  const std::tuple key{b.from, b.to, b.circuit};
  if (!parts_.contains(key)) order_.push_back(key);
  parts_[key].push_back({std::move(b), section, of.line()});
}

/// Combines the sections of a line in series; their charging becomes shunts at its ends.
void EpcReader::join_sections() {
  for (const auto& key : order_) {
    std::vector<Part>& parts = parts_[key];
    std::ranges::sort(parts, {}, &Part::section);
    network::Branch line = parts[0].branch;
    if (parts.size() > 1) {
      TwoPort all = TwoPort::of(line);
      for (std::size_t i = 1; i < parts.size(); ++i) {
        all = all.then(TwoPort::of(parts[i].branch));
        line.in_service = line.in_service && parts[i].branch.in_service;
      }
      const Complex z = -1.0 / all.y12;
      line.r = z.real();
      line.x = z.imag();
      line.b = 0.0;
      line.shunt_from = all.y11 + all.y12;
      line.shunt_to = all.y22 + all.y12;
    }
    network_.branches.push_back(std::move(line));
    branch_line_.push_back(parts[0].line);
  }
}

/// Returns the magnetising admittance at the bus of the primary winding [pu].
Complex EpcReader::magnetising(Fields& f, int bus) {
  const long double mva = f.number(kTbase, "tbase"), v = nominal(f, kVnomP, "vnomp", at(bus).kv);
  const long double scale = mva > 0 ? mva / base_ / (v * v) : 0.0L;
  return {static_cast<double>(f.number(kGmag, "gmag", 0.0L) * scale),
          static_cast<double>(f.number(kGmag + 1, "bmag", 0.0L) * scale)};
}

void EpcReader::transformer(const Row& row) {
  Fields of(row.of, file_, problems_), f(row.says, file_, problems_);
  const int from = of.integer(0, "from bus"), to = of.integer(3, "to bus"), table = f.integer(5, "zt", 0),
            tertiary = f.integer(kTertiary, "tertiary bus", 0);
  const std::array<int, 3> ends{find_bus(from, of), find_bus(to, of),
                                tertiary > 0 ? find_bus(tertiary, f) : -1};
  const bool on = status(f);
  std::string identity = "transformer " + ends_text(from, to);
  if (tertiary > 0) identity += "-" + std::to_string(tertiary);
  if (tertiary <= 0)  // lines and two-winding transformers have common circuit ids
    identity = "branch " + ends_text(std::min(from, to), std::max(from, to));
  network::Duplicate itself{network::Duplicate::Kind::branch, {from, to}};
  if (tertiary > 0) itself.buses.push_back(tertiary);
  const auto circuit = identities_.id(itself, identity + " circuit", id_of(of, 6), "", of);
  if (!circuit) return;
  if (table > 0 && units_only_)
    problems_.add("zt = " + std::to_string(table), of.where(), "impedance corrections of a .epc are not read",
                  "enter the impedance at the present tap, and set zt to 0");
  else if (table > 0)
    network_.remark("impedance corrections of transformers are ignored",
                    ends_text(from, to) + ", table " + std::to_string(table) + " (" + of.where() + ")");
  if (f.integer(kOhms, "ohm", 0) != 0)
    problems_.add(identity + " in ohms", f.where(), "only impedances per unit are read",
                  "save the case per unit");
  if (from == to || (tertiary > 0 && (tertiary == from || tertiary == to)))
    problems_.add("a transformer with two windings at one bus", of.where(), "they would be short-circuited",
                  "correct the bus numbers");
  if (ends[0] < 0 || ends[1] < 0 || (tertiary > 0 && ends[2] < 0)) return;
  if (tertiary > 0)
    three_windings(*circuit, f, ends, on);
  else
    two_windings(*circuit, f, ends[0], ends[1], on);
}

void EpcReader::two_windings(const std::string& circuit, Fields& f, int from, int to, bool on) {
  const Impedance z = pair_impedance(f, kPsR, "ps_r", "ps_x", f.number(kTbase, "tbase"), base_, problems_);
  const long double t1 = primary(f, at(from).kv, problems_),
                    t2 = other(f, kVnomS, kFixedS, at(to).kv, "secondary", problems_);
  network::Branch b = transformer_of(from, to, circuit, on, z * t2 * t2);
  b.tap = static_cast<double>(t1 / t2);
  b.shift = angle(f, kAngleP, "anglp") - angle(f, kAngleS, "angls");
  b.shunt_from = magnetising(f, from);
  raise_impedance(b, f);
  network_.branches.push_back(std::move(b));
}

void EpcReader::three_windings(const std::string& circuit, Fields& f, const std::array<int, 3>& ends,
                               bool on) {
  const long double tbase = f.number(kTbase, "tbase"), own_pt = f.number(kTbasePt, "tbasept", 0.0L),
                    own_ts = f.number(kTbaseTs, "tbasets", 0.0L);
  const Impedance ps = pair_impedance(f, kPsR, "ps_r", "ps_x", tbase, base_, problems_),
                  pt = pair_impedance(f, kPtR, "pt_r", "pt_x", own_pt > 0 ? own_pt : tbase, base_, problems_),
                  ts = pair_impedance(f, kTsR, "ts_r", "ts_x", own_ts > 0 ? own_ts : tbase, base_, problems_);
  const std::array<Impedance, 3> z = star_equivalent(ps, ts, pt);
  const std::array<long double, 3> turns{primary(f, at(ends[0]).kv, problems_),
                                         other(f, kVnomS, kFixedS, at(ends[1]).kv, "secondary", problems_),
                                         other(f, kVnomT, kFixedT, at(ends[2]).kv, "tertiary", problems_)};
  const std::array<double, 3> shift{angle(f, kAngleP, "anglp"), angle(f, kAngleS, "angls"),
                                    angle(f, kAngleT, "anglt")};
  const int internal = f.integer(kInternal, "internal bus", 0);
  const auto given = index_.find(internal);
  const int star = internal > 0 && given != index_.end()
                       ? given->second
                       : add_star_point(ends, circuit, on, at(ends[0]).vm, at(ends[0]).va);
  for (std::size_t i = 0; i < 3; ++i) {
    network::Branch b = transformer_of(ends[i], star, circuit, on, z[i]);
    b.tap = static_cast<double>(turns[i]);
    b.shift = shift[i];
    if (i == 0) b.shunt_from = magnetising(f, ends[0]);
    raise_impedance(b, f);
    network_.branches.push_back(std::move(b));
  }
}

}  // namespace swingbank::sim::formats::epc
