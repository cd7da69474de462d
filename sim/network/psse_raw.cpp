#include "sim/network/psse_raw.hpp"

#include <cmath>

namespace swingbank::sim {

Network read_raw(const std::filesystem::path& file) { return psse::RawReader(file).read(); }

namespace psse {

const std::array<RawReader::Section, 19> RawReader::kSections = {{
    {"bus", Use::read, &RawReader::bus},
    {"load", Use::read, &RawReader::load},
    {"fixed shunt", Use::read, &RawReader::fixed_shunt},
    {"generator", Use::read, &RawReader::generator},
    {"branch", Use::read, &RawReader::branch},
    {"transformer", Use::read, &RawReader::transformer},
    {"area", Use::skip},
    {"two-terminal dc line", Use::refuse},
    {"voltage source converter dc line", Use::refuse},
    {"impedance correction", Use::skip},
    {"multi-terminal dc line", Use::refuse},
    {"multi-section line", Use::skip},
    {"zone", Use::skip},
    {"inter-area transfer", Use::skip},
    {"owner", Use::skip},
    {"FACTS device", Use::refuse},
    {"switched shunt", Use::read, &RawReader::switched_shunt},
    {"GNE device", Use::refuse},
    {"induction machine", Use::refuse, nullptr, 33},
}};

Network RawReader::read() {
  network_.origin = file_;
  header();
  for (const Section& s : kSections)
    if (s.since <= version_ && !section(s)) break;
  finish();
  problems_.raise();
  return std::move(network_);
}

void RawReader::header() {
  if (lines_.size() < 3)
    throw InputError({"the file has " + std::to_string(lines_.size()) + " lines", file_,
                      "a .raw begins with a header and two title lines; it may be truncated",
                      "give a complete .raw file"});
  const Record record = split(lines_[0], 1, file_, problems_);
  Fields f(record, file_, problems_);
  const int change = f.integer(0, "IC", 0);
  base_ = static_cast<double>(
      f.number(1, "SBASE", 100.0L));  // the value the network holds, so that writing inverts reading
  version_ = f.integer(2, "REV");
  const double frequency = static_cast<double>(f.number(5, "BASFRQ"));
  problems_.raise();  // without these nothing below can be read
  if (version_ != 32 && version_ != 33)
    throw InputError({"version " + std::to_string(version_) + " of the .raw format", f.where(),
                      "versions 32 and 33 are read", "save the case as version 33"});
  if (change != 0)
    problems_.add("IC = " + std::to_string(change), f.where(), "the file adds to a case that is not here",
                  "save the whole case (IC = 0)");
  if (!(base_ > 0))
    problems_.add("SBASE = " + shortest(static_cast<double>(base_)) + " MVA", f.where(),
                  "everything is divided by it", "give a base > 0 MVA");
  if (!(frequency > 0))
    problems_.add("BASFRQ = " + shortest(frequency) + " Hz", f.where(), "the rotors turn at this frequency",
                  "give 50 or 60 Hz");
  network_.base_mva = static_cast<double>(base_);
  network_.frequency = frequency;
  const auto title = [](std::string line) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
  };
  network_.title = title(lines_[1]) + "\n" + title(lines_[2]);
  at_ = 3;
}

std::optional<Record> RawReader::next() {
  while (at_ < lines_.size()) {
    Record record = split(lines_[at_], static_cast<int>(at_) + 1, file_, problems_);
    ++at_;
    if (!record.fields.empty()) return record;
  }
  return {};
}

bool RawReader::section(const Section& section) {
  const std::string name = std::string(section.name) + " section";
  const int start = static_cast<int>(at_) + 1;
  while (auto record = next()) {
    const Field& first = record->fields[0];
    if (!first.quoted && first.text == "0") return true;
    if (!first.quoted && (first.text == "Q" || first.text == "q")) return false;
    if (section.use == Use::read) (this->*section.row)(*record);
    if (section.use == Use::refuse) {
      problems_.add("a record in the " + name, file_ + ":" + std::to_string(record->line),
                    "this equipment is not modelled", "remove it or replace it by an equivalent load");
      while (auto rest = next()) {  // one problem per section says it all; its records may span lines
        if (rest->fields[0].quoted) continue;
        if (rest->fields[0].text == "Q") return false;
        if (rest->fields[0].text == "0" && rest->fields.size() == 1) return true;
      }
    }
  }
  problems_.add("the file ends in the " + name, file_ + ":" + std::to_string(lines_.size()),
                "the section begins at line " + std::to_string(start) +
                    " and neither '0' nor 'Q' ends it: the file is truncated",
                "restore the file");
  return false;
}

int RawReader::find_bus(int number, const Fields& fields) {
  const auto found = index_.find(number);
  if (found != index_.end()) return found->second;
  problems_.add("bus " + std::to_string(number) + " is not in the bus section", fields.where(),
                "the record refers to it", "add the bus or correct the number");
  return -1;
}

void RawReader::once(const std::string& identity, const Fields& fields) {
  const auto [found, fresh] = seen_.emplace(identity, fields.line());
  if (!fresh)
    problems_.add(identity + " appears twice", fields.where(),
                  "it is already on line " + std::to_string(found->second),
                  "remove one or give it another id");
}

bool RawReader::status(int value, const char* name, const Fields& fields) {
  if (value != 0 && value != 1)
    problems_.add(std::string(name) + " = " + std::to_string(value), fields.where(), "a status is 0 or 1",
                  "give 1 (in service) or 0 (out of service)");
  return value == 1;
}

void RawReader::bus(const Record& record) {
  Fields f(record, file_, problems_);
  Bus b{};
  b.number = f.integer(0, "bus number");
  b.name = f.text(1, "");
  b.kv = static_cast<double>(f.number(2, "BASKV", 0.0L));
  const int type = f.integer(3, "IDE", 1);
  b.vm = static_cast<double>(f.number(7, "VM", 1.0L));
  b.va = static_cast<double>(f.number(8, "VA", 0.0L) / kDegrees);
  if (b.number < 0)
    problems_.add("bus number " + std::to_string(b.number), f.where(), "numbers are positive",
                  "give a positive number");
  if (type < 1 || type > 4)
    problems_.add("IDE = " + std::to_string(type), f.where(), "bus types are 1 to 4",
                  "give 1 (load), 2 (generator), 3 (slack) or 4 (isolated)");
  if (type != 4 && !(b.vm > 0))
    problems_.add("VM = " + shortest(b.vm) + " pu", f.where(), "the power flow starts from it",
                  "give a voltage > 0 pu");
  b.type = static_cast<BusType>(type);
  once("bus " + std::to_string(b.number), f);
  index_.emplace(b.number, static_cast<int>(network_.buses.size()));
  network_.buses.push_back(std::move(b));
}

void RawReader::load(const Record& record) {
  Fields f(record, file_, problems_);
  Load l{};
  l.bus = find_bus(f.integer(0, "bus number"), f);
  l.id = f.text(1, "1");
  const bool on = status(f.integer(2, "STATUS", 1), "STATUS", f);
  const auto mw = [&](std::size_t i, const char* name) { return pu(f.number(i, name, 0.0L)); };
  l.power = {mw(5, "PL"), mw(6, "QL")};
  l.current = {mw(7, "IP"), mw(8, "IQ")};
  l.admittance = {mw(9, "YP"),
                  pu(0.0L - f.number(10, "YQ", 0.0L))};  // PSS/E counts YQ as susceptance, not as consumption
  once("load '" + l.id + "' at bus " + f.text(0, ""), f);
  if (on && l.bus >= 0) network_.loads.push_back(std::move(l));
}

void RawReader::fixed_shunt(const Record& record) {
  Fields f(record, file_, problems_);
  Shunt s{};
  s.bus = find_bus(f.integer(0, "bus number"), f);
  s.id = f.text(1, "1");
  const bool on = status(f.integer(2, "STATUS", 1), "STATUS", f);
  s.admittance = {pu(f.number(3, "GL", 0.0L)), pu(f.number(4, "BL", 0.0L))};
  once("fixed shunt '" + s.id + "' at bus " + f.text(0, ""), f);
  if (on && s.bus >= 0) network_.shunts.push_back(std::move(s));
}

void RawReader::switched_shunt(const Record& record) {
  Fields f(record, file_, problems_);
  Shunt s{};
  s.bus = find_bus(f.integer(0, "bus number"), f);
  s.id = "SW";
  const bool on = status(f.integer(3, "STAT", 1), "STAT", f);
  s.admittance = {0.0, pu(f.number(9, "BINIT", 0.0L))};
  once("switched shunt at bus " + f.text(0, ""), f);
  if (on && s.bus >= 0 && s.admittance.imag() != 0.0) network_.shunts.push_back(std::move(s));
}

void RawReader::generator(const Record& record) {
  Fields f(record, file_, problems_);
  Generator g{};
  const int number = f.integer(0, "bus number");
  g.bus = find_bus(number, f);
  g.id = f.text(1, "1");
  g.p = pu(f.number(2, "PG", 0.0L));
  g.q = pu(f.number(3, "QG", 0.0L));
  g.q_max = pu(f.number(4, "QT", 9999.0L));
  g.q_min = pu(f.number(5, "QB", -9999.0L));
  g.vset = static_cast<double>(f.number(6, "VS", 1.0L));
  const int regulated = f.integer(7, "IREG", 0);
  g.mva = static_cast<double>(f.number(8, "MBASE", base_));
  g.zr = static_cast<double>(f.number(9, "ZR", 0.0L));
  g.zx = static_cast<double>(f.number(10, "ZX", 1.0L));
  const bool step_up = f.number(11, "RT", 0.0L) != 0 || f.number(12, "XT", 0.0L) != 0;
  g.in_service = status(f.integer(14, "STAT", 1), "STAT", f);
  once("generator '" + g.id + "' at bus " + std::to_string(number), f);
  if (!(g.mva > 0))
    problems_.add("MBASE = " + shortest(g.mva) + " MVA", f.where(),
                  "the machine's per-unit values refer to it", "give a base > 0 MVA");
  if (g.in_service && !(g.vset > 0))
    problems_.add("VS = " + shortest(g.vset) + " pu", f.where(), "it is the voltage the generator holds",
                  "give a voltage > 0 pu");
  if (g.in_service && regulated != 0 && regulated != number)
    problems_.add("IREG = " + std::to_string(regulated), f.where(),
                  "regulation of a remote bus is not modelled",
                  "set IREG to 0 and VS to the generator's own solved voltage");
  if (g.in_service && step_up)
    problems_.add("RT or XT is not zero", f.where(),
                  "a step-up transformer inside the generator record is not modelled",
                  "enter it as a transformer between two buses");
  if (g.bus < 0) return;
  generator_line_[network_.generators.size()] = record.line;
  network_.generators.push_back(std::move(g));
}

void RawReader::branch(const Record& record) {
  Fields f(record, file_, problems_);
  Branch b{};
  // A minus sign before the second bus only marks the metered end.
  const int from = f.integer(0, "from bus"), to = std::abs(f.integer(1, "to bus"));
  b.from = find_bus(from, f);
  b.to = find_bus(to, f);
  b.circuit = f.text(2, "1");
  const auto value = [&](std::size_t i, const char* name, std::optional<long double> fallback) {
    return static_cast<double>(f.number(i, name, fallback));
  };
  b.r = value(3, "R", 0.0L);
  b.x = value(4, "X", {});
  b.b = value(5, "B", 0.0L);
  b.shunt_from = {value(9, "GI", 0.0L), value(10, "BI", 0.0L)};
  b.shunt_to = {value(11, "GJ", 0.0L), value(12, "BJ", 0.0L)};
  b.in_service = status(f.integer(13, "ST", 1), "ST", f);
  const int low = std::min(from, to), high = std::max(from, to);
  once("branch " + std::to_string(low) + "-" + std::to_string(high) + " circuit '" + b.circuit + "'", f);
  if (b.from == b.to && b.from >= 0)
    problems_.add("a branch from bus " + std::to_string(from) + " to itself", f.where(), "it joins nothing",
                  "correct the bus numbers");
  if (b.r == 0.0 && b.x == 0.0)
    problems_.add("R = X = 0", f.where(), "a branch without impedance has no admittance",
                  "merge the two buses or give an impedance");
  if (b.from >= 0 && b.to >= 0) network_.branches.push_back(std::move(b));
}

void RawReader::finish() {
  const auto isolated = [&](int bus) {
    return network_.buses[static_cast<std::size_t>(bus)].type == BusType::isolated;
  };
  std::erase_if(network_.loads, [&](const Load& l) { return isolated(l.bus); });
  std::erase_if(network_.shunts, [&](const Shunt& s) { return isolated(s.bus); });
  for (Branch& b : network_.branches)
    if (isolated(b.from) || isolated(b.to)) b.in_service = false;
  std::map<int, double> held;
  for (std::size_t i = 0; i < network_.generators.size(); ++i) {
    Generator& g = network_.generators[i];
    if (isolated(g.bus)) g.in_service = false;
    if (!g.in_service) continue;
    const Bus& b = network_.buses[static_cast<std::size_t>(g.bus)];
    const std::string where = file_ + ":" + std::to_string(generator_line_[i]);
    if (b.type == BusType::load)
      problems_.add("a generator in service at bus " + std::to_string(b.number) + " of type 1", where,
                    "a load bus holds no voltage, so the generator would be ignored",
                    "make the bus type 2 or take the generator out of service");
    const auto [other, first] = held.emplace(g.bus, g.vset);
    if (!first && other->second != g.vset)
      problems_.add("VS = " + shortest(g.vset) + " pu", where,
                    "another generator at bus " + std::to_string(b.number) + " holds " +
                        shortest(other->second) + " pu",
                    "give both the same voltage");
  }
  if (network_.buses.empty() && problems_.empty())
    problems_.add("no buses", file_, "the bus section is empty", "give a case with buses");
}

}  // namespace psse
}  // namespace swingbank::sim
