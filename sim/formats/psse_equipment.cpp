// Reader of the single-line .raw records: buses, loads, shunts, generators, branches, switches.
#include <algorithm>
#include <array>
#include <cmath>

#include "sim/formats/detail/psse_raw.hpp"

namespace swingbank::sim::formats::psse {

void RawReader::bus(const Record& record) {
  Fields f(record, file_, problems_);
  network::Bus b{};
  b.number = f.integer(0, "bus number");
  b.name = f.text(1, "");
  b.kv = static_cast<double>(f.number(2, "BASKV", 0.0L));
  const int type = f.integer(3, "IDE", 1);
  if (!identities_.once("bus " + std::to_string(b.number), f)) return;
  const Columns& c = columns_;
  b.area = f.integer(c.bus_area, "AREA", 1);
  b.zone = f.integer(c.bus_area + 1, "ZONE", 1);
  b.owner = f.integer(c.bus_owner, "OWNER", 1);
  b.vm = static_cast<double>(f.number(c.bus_voltage, "VM", 1.0L));
  b.va = static_cast<double>(f.number(c.bus_voltage + 1, "VA", 0.0L) / kDegrees);
  if (type < 1 || type > 4)
    problems_.add("IDE = " + std::to_string(type), f.where(), "bus types are 1 to 4",
                  "give 1 (load), 2 (generator), 3 (slack) or 4 (isolated)");
  b.type = static_cast<network::BusType>(type);
  add_bus(std::move(b), f);
  if (version_ < 31 && version_ != 23) bus_shunt(f, 4);
}

/// Reads the shunt in a bus record, up to version 30.
void RawReader::bus_shunt(Fields& f, std::size_t first) {
  const Complex y{pu(f.number(first, "GL", 0.0L)), pu(f.number(first + 1, "BL", 0.0L))};
  if (y != Complex{}) network_.shunts.push_back({static_cast<int>(network_.buses.size()) - 1, "1", y});
}

/// Reads a bus of version 23, whose record contains load and shunt: I, IDE, PL, QL, GL, BL, AREA, VM, VA,
/// NAME, BASKV, ZONE.
void RawReader::bus_23(const Record& record) {
  constexpr std::array<std::size_t, 8> order{0, 9, 10, 1, 6, 11, 7, 8};  // order of bus(), without the shunt
  Record turned{record.line, record.ended, {}, record.place};
  for (const std::size_t i : order) {
    if (turned.fields.size() == 6) turned.fields.emplace_back();  // OWNER
    turned.fields.push_back(i < record.fields.size() ? record.fields[i] : Field{});
  }
  const Columns of_23 = columns_;
  columns_ = columns(31);
  const std::size_t before = network_.buses.size();
  bus(turned);
  columns_ = of_23;
  if (network_.buses.size() == before) return;
  Fields f(record, file_, problems_);
  bus_shunt(f, 4);
  network::Load l{};
  const network::Bus& b = network_.buses.back();
  l.bus = static_cast<int>(network_.buses.size()) - 1;
  l.id = "1";
  l.area = b.area;
  l.zone = b.zone;
  l.power = {pu(f.number(2, "PL", 0.0L)), pu(f.number(3, "QL", 0.0L))};
  if (l.power != Complex{}) network_.loads.push_back(std::move(l));
}

void RawReader::load(const Record& record) {
  Fields f(record, file_, problems_);
  network::Load l{};
  const int number = f.integer(0, "bus number");
  l.bus = find_bus(number, f);
  const auto id = identities_.id({network::Duplicate::Kind::load, {number}}, "load", f.text(1, "1"),
                                 " at bus " + f.text(0, ""), f);
  if (!id) return;
  l.id = *id;
  const bool on = status(f.integer(2, "STATUS", 1), "STATUS", f);
  const network::Bus of = l.bus < 0 ? network::Bus{} : network_.buses[static_cast<std::size_t>(l.bus)];
  l.area = f.integer(3, "AREA", of.area);
  l.zone = f.integer(4, "ZONE", of.zone);
  l.owner = f.integer(11, "OWNER", of.owner);
  const auto mw = [&](std::size_t i, const char* name) { return pu(f.number(i, name, 0.0L)); };
  l.power = {mw(5, "PL"), mw(6, "QL")};
  l.current = {mw(7, "IP"), mw(8, "IQ")};
  l.admittance = {mw(9, "YP"),
                  pu(0.0L - f.number(10, "YQ", 0.0L))};  // YQ is a susceptance in PSS/E, not a consumption
  if (version_ >= 34 && f.integer(16, "DGENM", 0) != 0 && on) {
    const Complex inside{pu(f.number(14, "DGENP", 0.0L)), pu(f.number(15, "DGENQ", 0.0L))};
    if (inside != Complex{})
      network_.remark("distributed generation inside a load is subtracted from its P and Q",
                      "load '" + l.id + "' at bus " + f.text(0, "") + " (" + f.where() + ")");
    l.power -= inside;
  }
  if (on && l.bus >= 0) network_.loads.push_back(std::move(l));
}

void RawReader::fixed_shunt(const Record& record) {
  Fields f(record, file_, problems_);
  network::Shunt s{};
  const int number = f.integer(0, "bus number");
  s.bus = find_bus(number, f);
  const bool on = status(f.integer(2, "STATUS", 1), "STATUS", f);
  s.admittance = {pu(f.number(3, "GL", 0.0L)), pu(f.number(4, "BL", 0.0L))};
  const auto id = identities_.id({network::Duplicate::Kind::shunt, {number}}, "fixed shunt", f.text(1, "1"),
                                 " at bus " + f.text(0, ""), f);
  if (!id) return;
  s.id = *id;
  if (on && s.bus >= 0) network_.shunts.push_back(std::move(s));
}

void RawReader::switched_shunt(const Record& record) {
  Fields f(record, file_, problems_);
  const int number = f.integer(0, "bus number");
  const std::string id = columns_.switched_id ? f.text(columns_.switched_id, "1") : "1";
  network::Shunt s{};
  s.bus = find_bus(number, f);
  const bool on = status(f.integer(columns_.switched_status, "STAT", 1), "STAT", f);
  s.admittance = {0.0, pu(f.number(columns_.switched_binit, "BINIT", 0.0L))};
  if (!identities_.once("switched shunt" + (columns_.switched_id ? " '" + id + "'" : "") + " at bus " +
                            std::to_string(number),
                        f))
    return;
  if (!on || s.bus < 0) return;
  s.id = switched_id(s.bus, id);
  switching(f, s);
  network_.shunts.push_back(std::move(s));  // kept even at 0 Mvar, because a model may refer to it
}

/// Reads mode, band and steps of a switched shunt. With MODSW 1 the blocks are switched in their order;
/// reactors and capacitors accumulate separately.
void RawReader::switching(Fields& f, const network::Shunt& shunt) {
  const int mode = f.integer(1 + columns_.switched_id, "MODSW", 1);
  const std::string place = "bus " + std::to_string(at(shunt.bus).number);
  if (mode == 0) return;
  if (mode != 1) {
    network_.remark("switched shunts with a control mode other than discrete steps stay at BINIT", place);
    return;
  }
  const std::size_t band = columns_.switched_status == kNoColumn ? 2 : columns_.switched_status + 1;
  network::SwitchedShunt s{shunt.bus, shunt.id, shunt.admittance.imag(), shunt.bus, 0.0, 0.0, {0.0}};
  s.most = static_cast<double>(f.number(band, "VSWHI", 1.0L));
  s.least = static_cast<double>(f.number(band + 1, "VSWLO", 1.0L));
  s.regulated = regulated_by(s.bus, f.integer(band + 2, "SWREG", 0), "SWREG = ", f);
  if (s.least > s.most && options_.drop_refused) {
    network_.remark("switched shunts with VSWLO above VSWHI stay at BINIT (--drop-refused)",
                    place + " (" + f.where() + ")");
    return;
  }
  if (s.least > s.most)
    problems_.add(place + ": VSWLO above VSWHI", f.where(), "the voltage band is empty",
                  "swap them, or keep the shunt at BINIT with --drop-refused");
  // Version 35 has a status before each block.
  const std::size_t stride = columns_.switched_id ? 3 : 2, blocks = 8;
  for (std::size_t k = 0; k < blocks; ++k) {
    const std::size_t first = columns_.switched_binit + 1 + stride * k;
    const bool on = stride == 2 || f.integer(first, "S", 1) != 0;
    const int steps = f.integer(first + stride - 2, "N", 0);
    const double each = pu(f.number(first + stride - 1, "B", 0.0L));
    add_steps(s, steps, on ? each : 0.0, f);
  }
  std::ranges::sort(s.steps);
  if (s.steps.size() > 1) network_.switched.push_back(std::move(s));
}

void RawReader::generator(const Record& record) {
  Fields f(record, file_, problems_);
  network::Generator g{};
  const int number = f.integer(0, "bus number");
  g.bus = find_bus(number, f);
  g.p = pu(f.number(2, "PG", 0.0L));
  g.q = pu(f.number(3, "QG", 0.0L));
  g.q_max = pu(f.number(4, "QT", 9999.0L));
  g.q_min = pu(f.number(5, "QB", -9999.0L));
  g.vset = static_cast<double>(f.number(6, "VS", 1.0L));
  const int regulated = f.integer(7, "IREG", 0);
  const std::size_t base = columns_.gen_base;
  g.mva = static_cast<double>(f.number(base, "MBASE", base_));
  g.zr = static_cast<double>(f.number(base + 1, "ZR", 0.0L));
  g.zx = static_cast<double>(f.number(base + 2, "ZX", 1.0L));
  g.rt = static_cast<double>(f.number(base + 3, "RT", 0.0L));
  g.xt = static_cast<double>(f.number(base + 4, "XT", 0.0L));
  const bool step_up = g.rt != 0.0 || g.xt != 0.0;
  const double tap = static_cast<double>(f.number(base + 5, "GTAP", 1.0L));
  g.in_service = status(f.integer(columns_.gen_status, "STAT", 1), "STAT", f);
  const auto id = identities_.id({network::Duplicate::Kind::generator, {number}}, "generator", f.text(1, "1"),
                                 " at bus " + std::to_string(number), f);
  if (!id) return;
  g.id = *id;
  const std::string place = "'" + g.id + "' at bus " + std::to_string(number) + " (" + f.where() + ")";
  check_machine(g, {"MBASE", "SBASE", "RT", "XT"}, place, f);
  if (units_only_ && g.in_service && step_up && tap != 1.0)
    problems_.add("GTAP = " + shortest(tap), f.where(),
                  "a step-up transformer inside the generator record is modelled at its nominal ratio",
                  "enter it as a transformer between two buses");
  else if (g.in_service && step_up && tap != 1.0)
    network_.remark("step-up transformers inside a generator's record are modelled at nominal ratio",
                    place + ": GTAP = " + shortest(tap));
  g.share = static_cast<double>(f.number(columns_.gen_status + 1, "RMPCT", 100.0L));
  if (g.bus < 0) return;
  const bool own_bus = g.in_service && !units_only_ && !(g.vset > 0);
  if (own_bus)
    regulate_own_bus(g, "generators with a set-point of 0 pu or below regulate to the file's voltage",
                     f.where());
  regulated_.push_back(own_bus || regulated == number ? 0 : regulated);
  if (!record.place.empty()) places_.push_back(record.place);
  network_.generators.push_back(std::move(g));
}

void RawReader::branch(const Record& record) {
  Fields f(record, file_, problems_);
  network::Branch b{};
  // A minus sign before the second bus marks the metered end.
  const int from = f.integer(0, "from bus"), to = std::abs(f.integer(1, "to bus"));
  b.from = find_bus(from, f);
  b.to = find_bus(to, f);
  const auto value = [&](std::size_t i, const char* name, std::optional<long double> fallback) {
    return static_cast<double>(f.number(i, name, fallback));
  };
  const std::size_t gi = columns_.branch_shunts;
  b.r = value(3, "R", 0.0L);
  b.x = value(4, "X", {});
  b.b = value(5, "B", 0.0L);
  b.shunt_from = {value(gi, "GI", 0.0L), value(gi + 1, "BI", 0.0L)};
  b.shunt_to = {value(gi + 2, "GJ", 0.0L), value(gi + 3, "BJ", 0.0L)};
  b.in_service = status(f.integer(columns_.branch_status, "ST", 1), "ST", f);
  const auto circuit = circuit_of(from, to, f.text(2, "1"), f);
  if (!circuit) return;
  b.circuit = *circuit;
  if (version_ < 28) {  // branches include transformers: RATIO (0: none), ANGLE
    const double ratio = value(9, "RATIO", 0.0L);
    b.shift = static_cast<double>(f.number(10, "ANGLE", 0.0L) / kDegrees);
    b.transformer = ratio != 0.0 || b.shift != 0.0;
    b.tap = ratio == 0.0 ? 1.0 : ratio;
  }
  check_ends("a branch", b, f);
  raise_impedance(b, f);
  if (b.from >= 0 && b.to >= 0) network_.branches.push_back(std::move(b));
}

// Reads a switching device as a line with its reactance, in service if closed. NSTAT, ratings and type are
// ignored.
void RawReader::switching_device(const Record& record) {
  Fields f(record, file_, problems_);
  network::Branch b{};
  const int from = f.integer(0, "from bus"), to = f.integer(1, "to bus");
  b.from = find_bus(from, f);
  b.to = find_bus(to, f);
  b.x = static_cast<double>(f.number(3, "X"));
  b.in_service = status(f.integer(16, "STAT", 1), "STAT", f);
  const auto circuit = circuit_of(from, to, f.text(2, "1"), f);
  if (!circuit) return;
  b.circuit = *circuit;
  check_ends("a switch", b, f);
  raise_impedance(b, f);
  if (b.from >= 0 && b.to >= 0) network_.branches.push_back(std::move(b));
}

}  // namespace swingbank::sim::formats::psse
