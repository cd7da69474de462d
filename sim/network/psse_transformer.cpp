// Two-winding transformers. In per unit on bus voltages a transformer is t1:1, the impedance, 1:t2; moved to
// one side: tap = t1/t2 with impedance z t2^2. Source: PSS/E Program Operation Manual, "Transformer Data".
#include <cmath>

#include "sim/network/psse_raw.hpp"

namespace swingbank::sim::psse {

namespace {

void unknown_code(const char* name, int value, int last, const Fields& f, Problems& problems) {
  problems.add(std::string(name) + " = " + std::to_string(value), f.where(),
               "the codes are 1 to " + std::to_string(last), "give one of them");
}

/// Turns ratio of one winding in per unit of its bus voltage. Fields: WINDV, NOMV.
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
                 "a winding needs turns", "give a value > 0");
    return 1.0L;
  }
  if (cw == 2) return winding / kv;
  if (cw == 3 && nominal != 0) return winding * nominal / kv;
  return winding;
}

/// Series impedance in per unit on the system base and bus voltages.
std::complex<long double> series(int cz, long double base, Fields& f, Problems& problems, long double& mva) {
  long double r = f.number(0, "R1-2", 0.0L), x = f.number(1, "X1-2");
  mva = f.number(2, "SBASE1-2", base);
  if (!(mva > 0)) {
    problems.add("SBASE1-2 = " + shortest(static_cast<double>(mva)) + " MVA", f.where(),
                 "the impedance refers to it", "give a base > 0 MVA");
    mva = base;
  }
  if (cz == 3) {  // R is the load loss in W, X the magnitude of the impedance
    r = r / 1e6L / mva;
    if (std::abs(x) < r) {
      problems.add("X1-2 = " + shortest(static_cast<double>(x)) + " pu", f.where(),
                   "the load loss alone makes a larger impedance",
                   "correct the loss in W or the impedance in pu");
    } else {
      x = std::copysign(std::sqrt(x * x - r * r), x);
    }
  }
  if (r == 0 && x == 0)
    problems.add("R1-2 = X1-2 = 0", f.where(), "a transformer without impedance has no admittance",
                 "merge the two buses or give an impedance");
  const long double scale = cz == 1 ? 1.0L : base / mva;
  return {r * scale, x * scale};
}

}  // namespace

void RawReader::transformer(const Record& first) {
  Fields f(first, file_, problems_);
  const int k = f.integer(2, "K", 0);
  std::array<Record, 4> rows{first, {}, {}, {}};
  for (std::size_t i = 1; i < 4; ++i) {
    auto record = next();
    if (!record) return;  // the section reports the truncation
    const Field& start = record->fields[0];
    if (record->fields.size() == 1 && !start.quoted && (start.text == "0" || start.text == "Q") && i != 3) {
      --at_;  // the section's end belongs to the section
      problems_.add("a transformer with " + std::to_string(i) + " lines", f.where(),
                    "a two-winding transformer takes 4", "complete the record");
      return;
    }
    rows[i] = std::move(*record);
  }
  if (k != 0) {
    next();
    problems_.add("a transformer with three windings", f.where(), "only two windings are modelled",
                  "replace it by two-winding transformers in star");
    return;
  }
  const int from = find_bus(f.integer(0, "from bus"), f), to = find_bus(f.integer(1, "to bus"), f);
  if (from >= 0 && to >= 0) two_windings(rows, from, to);
}

void RawReader::two_windings(const std::array<Record, 4>& rows, int from, int to) {
  Fields head(rows[0], file_, problems_), impedance(rows[1], file_, problems_), w1(rows[2], file_, problems_),
      w2(rows[3], file_, problems_);
  const int cw = head.integer(4, "CW", 1), cz = head.integer(5, "CZ", 1), cm = head.integer(6, "CM", 1);
  if (cw < 1 || cw > 3) unknown_code("CW", cw, 3, head, problems_);
  if (cz < 1 || cz > 3) unknown_code("CZ", cz, 3, head, problems_);
  if (cm < 1 || cm > 2) unknown_code("CM", cm, 2, head, problems_);
  const Bus &a = network_.buses[static_cast<std::size_t>(from)],
            &c = network_.buses[static_cast<std::size_t>(to)];

  Branch b{};
  b.transformer = true;
  b.from = from;
  b.to = to;
  b.circuit = head.text(3, "1");
  b.in_service = status(head.integer(11, "STAT", 1), "STAT", head);
  long double mva = base_;
  const auto z = series(cz, base_, impedance, problems_, mva);
  const long double t1 = turns(cw, a.kv, w1, "WINDV1", problems_),
                    t2 = turns(cw, c.kv, w2, "WINDV2", problems_);
  b.r = static_cast<double>(z.real() * t2 * t2);
  b.x = static_cast<double>(z.imag() * t2 * t2);
  b.tap = static_cast<double>(t1 / t2);
  b.shift = static_cast<double>(w1.number(2, "ANG1", 0.0L) / kDegrees);
  const int table = w1.integer(13, "TAB1", 0);
  if (table != 0)
    problems_.add("TAB1 = " + std::to_string(table), w1.where(),
                  "impedance correction tables are not modelled",
                  "enter the impedance at the present tap and set TAB1 to 0");

  long double g = head.number(7, "MAG1", 0.0L), m = head.number(8, "MAG2", 0.0L);
  if (cm == 2) {  // MAG1: no-load loss in W, MAG2: exciting current in pu of SBASE1-2 and NOMV1
    const long double nominal = w1.number(1, "NOMV1", 0.0L);
    const long double volt = nominal > 0 && a.kv > 0 ? static_cast<long double>(a.kv) / nominal : 1.0L;
    g = g / 1e6L / base_ * volt * volt;
    m = m * mva / base_ * volt * volt;
    if (std::abs(m) < g) {
      problems_.add("MAG2 = " + head.text(8, "0") + " pu", head.where(),
                    "the no-load loss alone draws a larger current", "correct MAG1 in W or MAG2 in pu");
    } else {
      m = -std::sqrt(m * m - g * g);
    }
  }
  b.shunt_from = {static_cast<double>(g), static_cast<double>(m)};
  const int low = std::min(a.number, c.number), high = std::max(a.number, c.number);
  once("branch " + std::to_string(low) + "-" + std::to_string(high) + " circuit '" + b.circuit + "'", head);
  if (from == to)
    problems_.add("a transformer from bus " + std::to_string(a.number) + " to itself", head.where(),
                  "it joins nothing", "correct the bus numbers");
  network_.branches.push_back(std::move(b));
}

}  // namespace swingbank::sim::psse
