// Reader of the .epc records at a single bus: buses, loads, shunts, generators, converters.
#include <algorithm>
#include <cmath>

#include "sim/formats/detail/epc_reader.hpp"

namespace swingbank::sim::formats::epc {

using psse::Fields;
using psse::shortest;

void EpcReader::bus(const Row& row) {
  Fields of(row.of, file_, problems_), f(row.says, file_, problems_);
  network::Bus b{};
  b.number = of.integer(0, "bus number");
  b.name = of.text(1, "");
  b.kv = static_cast<double>(of.number(2, "kV", 0.0L));
  const int type = f.integer(0, "ty");
  const double vsched = static_cast<double>(f.number(1, "vsched"));
  b.vm = static_cast<double>(f.number(2, "volt"));
  b.va = static_cast<double>(f.number(3, "angle") / psse::kDegrees);
  b.area = f.integer(4, "ar", 1);
  b.zone = f.integer(5, "zone", 1);
  b.owner = f.integer(12, "own", 1);
  if (!identities_.once("bus " + std::to_string(b.number), of)) return;
  b.type = type == 0             ? network::BusType::slack
           : std::abs(type) == 2 ? network::BusType::generator
                                 : network::BusType::load;
  if (type != 1 && type != 0 && std::abs(type) != 2)
    problems_.add("ty = " + std::to_string(type), of.where(),
                  "bus types are 0 (swing), 1 (load), 2 and -2 (regulated by generators)",
                  "give one of these");
  if (f.integer(13, "st", 0) != 0) {
    b.type = network::BusType::isolated;
    network_.remark("buses whose st is not 0 are out of service",
                    "bus " + std::to_string(b.number) + " (" + of.where() + ")");
  }
  vsched_.push_back(vsched > 0 ? vsched : 0.0);
  add_bus(std::move(b), of);
}

void EpcReader::load(const Row& row) {
  Fields of(row.of, file_, problems_), f(row.says, file_, problems_);
  network::Load l{};
  const int number = of.integer(0, "bus number");
  l.bus = find_bus(number, of);
  const auto id = identities_.id({network::Duplicate::Kind::load, {number}}, "load", id_of(of, 3),
                                 " at bus " + of.text(0, ""), of);
  if (!id) return;
  l.id = *id;
  const bool on = status(f);
  const auto mw = [&](std::size_t i, const char* name) { return pu(f.number(i, name, 0.0L)); };
  l.power = {mw(1, "mw"), mw(2, "mvar")};
  l.current = {mw(3, "mw_i"), mw(4, "mvar_i")};
  l.admittance = {mw(5, "mw_z"), mw(6, "mvar_z")};
  if (l.bus < 0) return;
  l.area = f.integer(7, "ar", at(l.bus).area);
  l.zone = f.integer(8, "zone", at(l.bus).zone);
  l.owner = f.integer(13, "own", at(l.bus).owner);
  if (on) network_.loads.push_back(std::move(l));
}

void EpcReader::shunt(const Row& row) {
  Fields of(row.of, file_, problems_), f(row.says, file_, problems_);
  network::Shunt s{};
  const int number = of.integer(0, "bus number");
  s.bus = find_bus(number, of);
  const bool on = status(f);
  s.admittance = {static_cast<double>(f.number(3, "pu_mw")), static_cast<double>(f.number(4, "pu_mvar"))};
  const int far = of.size() > 6 ? of.integer(4, "far bus", 0) : 0;
  const std::string at_branch =
      far > 0 ? " of the branch to bus " + std::to_string(far) + " circuit '" + id_of(of, 7) + "'" : "";
  if (far > 0) {  // the id identifies the end of the branch and cannot be replaced
    if (!identities_.once("shunt '" + id_of(of, 3) + "' at bus " + std::to_string(number) + at_branch, of))
      return;
  } else if (const auto id = identities_.id({network::Duplicate::Kind::shunt, {number}}, "shunt",
                                            id_of(of, 3), " at bus " + std::to_string(number), of)) {
    s.id = *id;
  } else {
    return;
  }
  if (!on || s.bus < 0) return;
  if (far > 0)
    line_shunt(of, f, s.admittance);
  else
    network_.shunts.push_back(std::move(s));
}

/// Reads a shunt that is switched with a branch. An id 'f...' means the end at the record's first bus, 't...'
/// the end at its second bus.
void EpcReader::line_shunt(Fields& of, Fields& f, Complex y) {
  const int from = find_bus(of.integer(0, "bus number"), of), to = find_bus(of.integer(4, "far bus"), of);
  const std::string id = id_of(of, 3), circuit = id_of(of, 7);
  const int section = std::max(of.integer(8, "se", 1), 1);
  const bool first = id[0] == 'f' || id[0] == 'F', second = id[0] == 't' || id[0] == 'T';
  if (!first && !second)
    problems_.add("shunt '" + id + "' of a branch", f.where(),
                  "its id must begin with f or t, the end of the branch", "correct the id");
  for (const bool turned : {false, true}) {
    const auto found = parts_.find({turned ? to : from, turned ? from : to, circuit});
    if (found == parts_.end()) continue;
    for (Part& part : found->second)
      if (part.section == section) {
        (first == turned ? part.branch.shunt_to : part.branch.shunt_from) += y;
        return;
      }
  }
  if (from >= 0 && to >= 0)
    problems_.add("a shunt of the branch to bus " + of.text(4, "") + " circuit '" + circuit + "'", f.where(),
                  "the branch section has no such branch", "correct the record");
}

void EpcReader::svd(const Row& row) {
  Fields of(row.of, file_, problems_), f(row.says, file_, problems_);
  network::Shunt s{};
  const int number = of.integer(0, "bus number");
  s.bus = find_bus(number, of);
  const std::string id = id_of(of, 3);
  const bool on = status(f);
  const int type = f.integer(1, "ty"), regulated = f.integer(2, "regulated bus", 0);
  s.admittance = {static_cast<double>(f.number(7, "g")), static_cast<double>(f.number(8, "b"))};
  if (!identities_.once("svd '" + id + "' at bus " + std::to_string(number), of)) return;
  if (!on || s.bus < 0) return;
  s.id = switched_id(s.bus, id);
  if (type == 1)
    steps_of(row, s, regulated, f);
  else if (type != 0)
    network_.remark("shunts (svd) with a control type other than discrete steps stay at b",
                    "bus " + std::to_string(number) + " (" + of.where() + ")");
  network_.shunts.push_back(std::move(s));
}

/// Reads the steps of an svd of type 1, which regulates a bus to vsched within vband. The second line has
/// pairs of number and size of steps.
void EpcReader::steps_of(const Row& row, const network::Shunt& shunt, int regulated, Fields& f) {
  constexpr std::size_t columns = 26, blocks = 10;
  const std::size_t first = row.starts.empty() ? columns : row.starts[0];
  const double band = std::abs(static_cast<double>(f.number(11, "vband", 0.0L)));
  const int regulated_bus = regulated_by(shunt.bus, std::max(regulated, 0), "regulated bus ", f);
  network::SwitchedShunt s{shunt.bus, shunt.id, shunt.admittance.imag(), regulated_bus, 0.0, 0.0, {0.0}};
  for (std::size_t k = 0; k < blocks; ++k) {
    const int steps = f.integer(first + 2 * k, "n", 0);
    const double each = static_cast<double>(f.number(first + 2 * k + 1, "b of a step", 0.0L));
    add_steps(s, steps, each, f);
  }
  if (s.steps.size() == 1) return;  // no steps to switch
  const double setpoint = vsched_[static_cast<std::size_t>(regulated_bus)];
  s.least = setpoint - band;
  s.most = setpoint + band;
  std::ranges::sort(s.steps);
  if (setpoint > 0) network_.switched.push_back(std::move(s));
}

void EpcReader::generator(const Row& row) {
  Fields of(row.of, file_, problems_), f(row.says, file_, problems_);
  network::Generator g{};
  const int number = of.integer(0, "bus number"), regulated = f.integer(1, "regulated bus", 0);
  g.bus = find_bus(number, of);
  const auto id = identities_.id({network::Duplicate::Kind::generator, {number}}, "generator", id_of(of, 3),
                                 " at bus " + std::to_string(number), of);
  if (!id) return;
  g.id = *id;
  g.in_service = status(f);
  g.share = static_cast<double>(f.number(5, "qrf", 1.0L) * 100.0L);
  g.p = pu(f.number(8, "pgen"));
  g.q = pu(f.number(11, "qgen"));
  g.q_max = pu(f.number(12, "qmax"));
  g.q_min = pu(f.number(13, "qmin"));
  g.mva = static_cast<double>(f.number(14, "mbase"));
  g.zr = static_cast<double>(f.number(17, "gen_r", 0.0L));
  g.zx = static_cast<double>(f.number(18, "gen_x", 0.0L));
  const std::size_t second = row.starts.empty() ? 29 : row.starts[0];
  g.rt = static_cast<double>(f.number(second, "rtran", 0.0L));
  g.xt = static_cast<double>(f.number(second + 1, "xtran", 0.0L));
  const double tap = static_cast<double>(f.number(second + 2, "gtap", 1.0L));
  if (g.bus < 0) return;
  const std::string where = "'" + g.id + "' at bus " + std::to_string(number) + " (" + f.where() + ")";
  check_machine(g, {"mbase", "sbase", "rtran", "xtran"}, where, f);
  const bool step_up = g.rt != 0.0 || g.xt != 0.0;
  if (units_only_ && g.in_service && step_up && tap != 1.0)
    problems_.add("gtap = " + shortest(tap), f.where(),
                  "a step-up transformer inside the generator record is modelled at its nominal ratio",
                  "enter it as a transformer between two buses");
  else if (g.in_service && step_up && tap != 1.0)
    network_.remark("step-up transformers inside a generator's record are modelled at nominal ratio",
                    where + ": gtap = " + shortest(tap));
  int regulated_bus = g.bus;
  if (const auto found = index_.find(regulated); found != index_.end())
    regulated_bus = found->second;
  else if (regulated > 0 && g.in_service && !units_only_)
    network_.remark("generators that regulate a missing bus regulate their own", where);
  g.regulated = regulated_bus == g.bus ? -1 : regulated_bus;
  g.vset = vsched_[static_cast<std::size_t>(regulated_bus)];
  if (!(g.vset > 0)) {
    if (g.in_service && !units_only_)
      network_.remark("generators with a set-point of 0 pu or below regulate to the file's voltage", where);
    g.regulated = -1;
    g.vset = at(g.bus).vm;
  }
  network_.generators.push_back(std::move(g));
}

/// Reads a converter of a dc line; its first bus is the ac bus.
void EpcReader::converter(const Row& row) {
  Fields of(row.of, file_, problems_), f(row.says, file_, problems_);
  const int number = of.integer(0, "ac bus number"), bus = find_bus(number, of);
  if (!status(f) || bus < 0) return;
  devices_.push_back({"dc converter '" + of.text(6, std::to_string(number)) + "'", of.where(), {bus}});
}

}  // namespace swingbank::sim::formats::epc
