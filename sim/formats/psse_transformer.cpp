// Reader of transformers with two and three windings. In per unit of the bus voltages, a winding is an ideal
// ratio t:1. A two-winding transformer is t1:1, the impedance z, 1:t2; this equals tap = t1/t2 with impedance
// z t2^2. Three windings meet at a star point. Each winding has its ratio t:1 and one branch of the star
// equivalent of the three pairwise impedances. Source: PSS/E Program Operation Manual, "Transformer Data".
#include <algorithm>
#include <cmath>

#include "sim/formats/detail/psse_raw.hpp"

namespace swingbank::sim::formats::psse {

struct RawReader::Codes {
  int cw, cz, cm;
};

namespace {

void unknown_code(const char* name, int value, int last, const Fields& f, Problems& problems) {
  problems.add(std::string(name) + " = " + std::to_string(value), f.where(),
               "the codes range from 1 to " + std::to_string(last), "give one of them");
}

/// Returns the turns ratio of one winding in per unit of its bus voltage. Fields: WINDV, NOMV.
long double turns(int cw, long double kv, Fields& f, const char* name, Problems& problems) {
  if (cw != 1 && !(kv > 0)) {
    problems.add("CW = " + std::to_string(cw), f.where(),
                 "the bus has no BASKV to refer the winding voltage to",
                 "give BASKV of the bus or use CW = 1");
    return 1.0L;
  }
  const long double winding = f.number(0, name, cw == 2 ? kv : 1.0L);
  const long double nominal = f.number(1, "NOMV", 0.0L);
  if (!(winding > 0)) {
    problems.add(std::string(name) + " = " + shortest(static_cast<double>(winding)), f.where(),
                 "a turns ratio must be positive", "give a value > 0");
    return 1.0L;
  }
  if (cw == 2) return winding / kv;
  if (cw == 3 && nominal != 0) return winding * nominal / kv;
  return winding;
}

/// Returns the series impedance between one pair of windings ("1-2") in per unit of the system base and bus
/// voltages. Its fields R, X, SBASE begin at `first`.
Impedance series(int cz, long double base, Fields& f, std::size_t first, const std::string& pair,
                 network::Network& network, Problems& problems, long double& mva) {
  long double r = f.number(first, ("R" + pair).c_str(), 0.0L), x = f.number(first + 1, ("X" + pair).c_str());
  mva = f.number(first + 2, ("SBASE" + pair).c_str(), base);
  if (!(mva > 0)) {
    const std::string given = "SBASE" + pair + " = " + shortest(static_cast<double>(mva)) + " MVA";
    if (cz == 1)
      network.remark("winding bases of 0 MVA or below are replaced by SBASE", given + " (" + f.where() + ")");
    else
      problems.add(given, f.where(), "the impedance refers to it", "give a base > 0 MVA");
    mva = base;
  }
  if (cz == 3) {  // R is the load loss in W, X the magnitude of the impedance
    r = r / 1e6L / mva;
    if (std::abs(x) < r) {
      problems.add("X" + pair + " = " + shortest(static_cast<double>(x)) + " pu", f.where(),
                   "the load loss alone requires a larger impedance",
                   "correct the loss in W or the impedance in pu");
    } else {
      x = std::copysign(std::sqrt(x * x - r * r), x);
    }
  }
  const long double scale = cz == 1 ? 1.0L : base / mva;
  return {r * scale, x * scale};
}

}  // namespace

void RawReader::transformer(const Record& first) {
  Fields f(first, file_, problems_);
  const int k = f.integer(2, "K", 0);
  const std::size_t lines = k == 0 ? 4 : 5;
  std::vector<Record> rows{first};
  while (rows.size() < lines) {
    auto record = next();
    if (!record) return;  // the section reports the truncation
    if (record->fields.size() == 1 && (ends_section(*record) || ends_file(*record))) {
      put_back(*record);  // section() handles the end of the section
      problems_.add(
          "a transformer with " + std::to_string(rows.size()) + " lines", f.where(),
          k == 0 ? "a transformer with two windings has 4" : "a transformer with three windings has 5",
          "complete the record");
      return;
    }
    rows.push_back(std::move(*record));
  }
  transformer_lines(rows);
}

void RawReader::transformer_lines(std::span<const Record> rows) {
  Fields f(rows[0], file_, problems_);
  const int k = f.integer(2, "K", 0);
  // A minus sign before a bus marks the metered end.
  std::array<int, 3> ends{find_bus(std::abs(f.integer(0, "from bus")), f),
                          find_bus(std::abs(f.integer(1, "to bus")), f), -1};
  if (k != 0) ends[2] = find_bus(std::abs(k), f);
  if (ends[0] < 0 || ends[1] < 0) return;
  if (k == 0) return two_windings(rows, ends[0], ends[1]);
  if (ends[2] >= 0) three_windings(rows, ends);
}

RawReader::Codes RawReader::codes(Fields& head) {
  const Codes c{head.integer(4, "CW", 1), head.integer(5, "CZ", 1), head.integer(6, "CM", 1)};
  if (c.cw < 1 || c.cw > 3) unknown_code("CW", c.cw, 3, head, problems_);
  if (c.cz < 1 || c.cz > 3) unknown_code("CZ", c.cz, 3, head, problems_);
  if (c.cm < 1 || c.cm > 2) unknown_code("CM", c.cm, 2, head, problems_);
  return c;
}

void RawReader::note_table(Fields& winding, std::size_t number, std::size_t branch) {
  const std::string name = "TAB" + std::to_string(number);
  const int table = winding.integer(columns_.winding_table, name.c_str(), 0);
  if (table != 0)
    corrections_.push_back({branch, table, name, static_cast<double>(winding.number(0, "WINDV", 1.0L)),
                            static_cast<double>(winding.number(2, "ANG", 0.0L)), winding.where()});
}

Complex RawReader::magnetising(Fields& head, Fields& winding, const Codes& codes, long double mva,
                               const network::Bus& bus) {
  long double g = head.number(7, "MAG1", 0.0L), m = head.number(8, "MAG2", 0.0L);
  if (codes.cm == 2) {  // MAG1: no-load loss in W, MAG2: exciting current in pu of SBASE1-2 and NOMV1
    const long double nominal = winding.number(1, "NOMV1", 0.0L);
    const long double volt = nominal > 0 && bus.kv > 0 ? static_cast<long double>(bus.kv) / nominal : 1.0L;
    g = g / 1e6L / base_ * volt * volt;
    m = m * mva / base_ * volt * volt;
    if (std::abs(m) < g) {
      problems_.add("MAG2 = " + head.text(8, "0") + " pu", head.where(),
                    "the no-load loss alone draws a larger current", "correct MAG1 in W or MAG2 in pu");
    } else {
      m = -std::sqrt(m * m - g * g);
    }
  }
  return {static_cast<double>(g), static_cast<double>(m)};
}

void RawReader::two_windings(std::span<const Record> rows, int from, int to) {
  Fields head(rows[0], file_, problems_), impedance(rows[1], file_, problems_), w1(rows[2], file_, problems_),
      w2(rows[3], file_, problems_);
  const Codes code = codes(head);
  const auto circuit = circuit_of(at(from).number, at(to).number, head.text(3, "1"), head);
  if (!circuit) return;
  const bool on = status(head.integer(11, "STAT", 1), "STAT", head);
  long double mva = base_;
  const Impedance z = series(code.cz, base_, impedance, 0, "1-2", network_, problems_, mva);
  const long double t1 = turns(code.cw, at(from).kv, w1, "WINDV1", problems_),
                    t2 = turns(code.cw, at(to).kv, w2, "WINDV2", problems_);
  network::Branch b = transformer_of(from, to, *circuit, on, z * t2 * t2);
  b.tap = static_cast<double>(t1 / t2);
  b.shift = static_cast<double>(w1.number(2, "ANG1", 0.0L) / kDegrees);
  check_ends("a transformer", b, head);
  raise_impedance(b, impedance);
  note_table(w1, 1, network_.branches.size());
  b.shunt_from = magnetising(head, w1, code, mva, at(from));
  network_.branches.push_back(std::move(b));
}

void RawReader::three_windings(std::span<const Record> rows, const std::array<int, 3>& ends) {
  Fields head(rows[0], file_, problems_), impedances(rows[1], file_, problems_);
  const Codes code = codes(head);
  const int status = head.integer(11, "STAT", 1);  // 2, 3, 4: only winding 2, 3, 1 is out
  if (status < 0 || status > 4)
    problems_.add("STAT = " + std::to_string(status), head.where(),
                  "with three windings it is 0 (out), 1 (in) or 2, 3, 4 (winding 2, 3 or 1 out)",
                  "give one of these");
  long double mva = base_, other = base_;
  const Impedance z12 = series(code.cz, base_, impedances, 0, "1-2", network_, problems_, mva),
                  z23 = series(code.cz, base_, impedances, 3, "2-3", network_, problems_, other),
                  z31 = series(code.cz, base_, impedances, 6, "3-1", network_, problems_, other);
  const std::array<int, 3> out{4, 2, 3};
  const std::array<const char*, 3> names{"WINDV1", "WINDV2", "WINDV3"};
  std::string identity = "transformer " + std::to_string(at(ends[0]).number);
  for (std::size_t i = 1; i < 3; ++i) identity += "-" + std::to_string(at(ends[i]).number);
  const auto circuit = identities_.id(
      {network::Duplicate::Kind::branch, {at(ends[0]).number, at(ends[1]).number, at(ends[2]).number}},
      identity + " circuit", head.text(3, "1"), "", head);
  if (!circuit) return;
  if (ends[0] == ends[1] || ends[1] == ends[2] || ends[2] == ends[0])
    problems_.add("two windings at one bus", head.where(), "they would be short-circuited",
                  "correct the bus numbers");
  const double vm = static_cast<double>(impedances.number(9, "VMSTAR", 1.0L)),
               va = static_cast<double>(impedances.number(10, "ANSTAR", 0.0L) / kDegrees);
  const int star = add_star_point(ends, *circuit, status != 0, vm > 0 ? vm : 1.0, va);
  if (!(vm > 0))  // affects only the initial guess of the power flow
    network_.remark("star-point voltages of 0 pu or below are replaced by 1 pu",
                    at(star).name + ": VMSTAR = " + shortest(vm) + " pu (" + impedances.where() + ")");
  const std::array<Impedance, 3> z = star_equivalent(z12, z23, z31);
  for (std::size_t i = 0; i < 3; ++i) {
    Fields w(rows[2 + i], file_, problems_);
    network::Branch b = transformer_of(ends[i], star, *circuit, status != 0 && status != out[i], z[i]);
    raise_impedance(b, impedances);
    b.tap = static_cast<double>(turns(code.cw, at(ends[i]).kv, w, names[i], problems_));
    b.shift = static_cast<double>(w.number(2, "ANG", 0.0L) / kDegrees);
    note_table(w, i + 1, network_.branches.size());
    if (i == 0) b.shunt_from = magnetising(head, w, code, mva, at(ends[0]));
    network_.branches.push_back(std::move(b));
  }
}

/// Reads one correction table: points of T and factor. The factor is complex from version 34 on. A zero point
/// or the end of the record ends the table; from version 34 on, it continues over lines until a zero point.
void RawReader::correction_table(const Record& first) {
  const std::size_t width = version_ >= 34 ? 3 : 2;
  Fields head(first, file_, problems_);
  std::vector<std::pair<double, Complex>>& points = tables_[head.integer(0, "table number")];
  Record record = first;
  for (std::size_t from = 1;; from = 0) {
    Fields f(record, file_, problems_);
    bool over = version_ < 34;
    for (std::size_t i = from; i + 1 < f.size(); i += width) {
      const double t = static_cast<double>(f.number(i, "T", 0.0L)),
                   re = static_cast<double>(f.number(i + 1, "F", 0.0L)),
                   im = width == 3 ? static_cast<double>(f.number(i + 2, "Im(F)", 0.0L)) : 0.0;
      over = t == 0.0 && re == 0.0 && im == 0.0;
      if (over) break;
      points.emplace_back(t, Complex(re, im));
    }
    // An incomplete line, or one with a zero point, ends the table.
    if (over || f.size() < from + 6 * width) break;
    auto more = next();
    if (!more || more->fields.empty()) break;
    const bool fresh = more->fields.size() % width == 1;  // a table number precedes the points
    if (fresh || (ends_section(*more) && more->fields.size() == 1) || ends_file(*more)) {
      put_back(*more);
      break;
    }
    record = std::move(*more);
  }
  if (!std::ranges::is_sorted(points, {}, [](const auto& p) { return p.first; }))
    unsorted(head.integer(0, "table number", 0), head);
}

void RawReader::unsorted(int table, const Fields& f) {
  problems_.add("unsorted correction table " + std::to_string(table), f.where(),
                "the T of its points must ascend", "sort the points by T");
}

/// Corrects impedances at the present tap or angle. T is a ratio if all points are between 0.5 and 1.5, else
/// an angle in degrees. The factor is interpolated linearly and is constant beyond the end points.
void RawReader::correct_impedances() {
  for (const Correction& c : corrections_) {
    const auto found = tables_.find(c.table);
    if (found == tables_.end() || found->second.empty()) {
      if (options_.drop_refused)
        network_.remark("missing impedance correction tables are ignored (--drop-refused)",
                        c.name + " = " + std::to_string(c.table) + " (" + c.where + ")");
      else
        problems_.add(c.name + " = " + std::to_string(c.table), c.where, "there is no such correction table",
                      "add the table, set TAB to 0, or ignore it with --drop-refused");
      continue;
    }
    const auto& points = found->second;
    const bool ratios = points.front().first >= 0.5 && points.back().first <= 1.5;
    const double t = ratios ? c.ratio : c.angle;
    const auto above = std::ranges::find_if(points, [&](const auto& p) { return p.first >= t; });
    Complex factor = above == points.end() ? points.back().second : above->second;
    if (above != points.begin() && above != points.end()) {
      const auto& [t0, f0] = above[-1];
      factor = f0 + (above->second - f0) * ((t - t0) / (above->first - t0));
    }
    network::Branch& b = network_.branches[c.branch];
    const Complex z = Complex(b.r, b.x) * factor;
    if (z == Complex{}) {
      problems_.add("correction table " + std::to_string(c.table), c.where,
                    "its factor is zero at the present tap or angle", "correct the table");
      continue;
    }
    b.r = z.real();
    b.x = z.imag();
    network_.remark("impedances are corrected for the present tap or angle, which is fixed",
                    network_.branch_text(b) + " by " + shortest(factor.real()) + " (" + c.where + ")");
  }
}

}  // namespace swingbank::sim::formats::psse
