#include "sim/formats/event_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

namespace swingbank::sim::formats {
namespace {

std::vector<std::string> fields(const std::string& text) {
  std::vector<std::string> list(1);
  for (const char c : text)
    if (c == ':')
      list.emplace_back();
    else
      list.back() += c;
  return list;
}

double number(const std::string& text, const std::string& where, Problems& problems) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec == std::errc{} && read.ptr == end && std::isfinite(value)) return value;
  problems.add("'" + text + "' is not a number", where, "it must be a finite number", "write it like 2.05");
  return 0.0;
}

double event_time(const std::string& text, double t_end, const std::string& where, Problems& problems) {
  const double t = number(text, where, problems);
  if (t > t_end)
    problems.add(fmt::format("an event at {:g} s in a run of {:g} s", t, t_end), where,
                 "it is after the end of the run", "choose an earlier time or increase --t-end");
  return t;
}

/// Returns the fields of `text`. If there are fewer than `least` or more than `most`, returns none and adds a
/// problem.
std::vector<std::string> fields(const std::string& text, std::size_t least, std::size_t most,
                                const std::string& form, const std::string& where, Problems& problems) {
  auto part = fields(text);
  if (part.size() >= least && part.size() <= most) return part;
  problems.add(fmt::format("{} fields in '{}'", part.size(), text), where, "the form is " + form,
               "write it in this form");
  return {};
}

/// Returns the branches between two buses with this circuit id. Of a three-winding transformer that connects
/// both buses, this is the winding at the first bus. For three buses, returns the windings in service of the
/// transformer between them, or all its windings if none is in service.
std::vector<int> branches_named(const std::vector<std::string>& ends, const std::string& circuit,
                                const network::Network& network) {
  const auto bus_of = [&](int index) -> const network::Bus& {
    return network.buses[static_cast<std::size_t>(index)];
  };
  std::vector<int> list, out;
  if (ends[0] == ends[1]) return list;
  for (std::size_t i = 0; i < network.branches.size(); ++i) {
    const network::Branch& b = network.branches[i];
    if (b.circuit != circuit) continue;
    std::vector<std::string> joined{std::to_string(bus_of(b.from).number)};
    if (bus_of(b.to).is_star())
      for (const int number : bus_of(b.to).star_of) joined.push_back(std::to_string(number));
    else
      joined.push_back(std::to_string(bus_of(b.to).number));
    const bool joins = std::ranges::all_of(
        ends, [&](const std::string& end) { return std::ranges::count(joined, end) > 0; });
    const bool named = ends.size() == 3         ? bus_of(b.to).is_star()
                       : bus_of(b.to).is_star() ? joined.front() == ends.front()
                                                : true;
    if (joins && named) (b.in_service || ends.size() < 3 ? list : out).push_back(static_cast<int>(i));
  }
  return list.empty() ? out : list;
}

int bus_number(const network::Network& network, const network::Generator& g) {
  return network.buses[static_cast<std::size_t>(g.bus)].number;
}

}  // namespace

int generator_named(const network::Network& network, const std::string& text, const std::string& where,
                    Problems& problems) {
  const auto slash = text.find('/');
  const std::string bus = text.substr(0, slash), id = slash == text.npos ? "" : text.substr(slash + 1);
  std::string names, same;
  int found = -1, count = 0;
  for (std::size_t i = 0; i < network.generators.size(); ++i) {
    const network::Generator& g = network.generators[i];
    if (!g.in_service) continue;
    const std::string name = std::to_string(bus_number(network, g)) + "/" + g.id;
    names += (names.empty() ? "" : ", ") + name;
    if (std::to_string(bus_number(network, g)) != bus || (slash != text.npos && g.id != id)) continue;
    same += (same.empty() ? "" : ", ") + name;
    found = static_cast<int>(i);
    ++count;
  }
  if (count == 1) return found;
  if (count == 0)
    problems.add("no generator " + text, where, "in service in " + network.origin + " are " + names,
                 "name one of these");
  else
    problems.add("ambiguous generator " + text, where, "several generators match: " + same,
                 "name one of these");
  return -1;
}

int read_bus(const std::string& text, const network::Network& network, const std::string& where,
             Problems& problems) {
  for (std::size_t i = 0; i < network.buses.size(); ++i)
    if (!network.buses[i].is_star() && std::to_string(network.buses[i].number) == text)
      return static_cast<int>(i);
  problems.add("no bus " + text, where, network.origin + " has no bus of that number",
               "give a bus number of that file");
  return -1;
}

network::BusFault read_fault(const std::string& text, const network::Network& network, double t_end,
                             const std::string& where, Problems& problems) {
  const auto part = fields(text);
  if (part.size() != 3 && part.size() != 5) {
    problems.add(
        fmt::format("{} fields in '{}'", part.size(), text), where,
        "a fault is BUS:T_ON:T_OFF or BUS:T_ON:T_OFF:R:X",
        "give bus number, start [s], end [s] and, if it is not bolted, R and X [pu on the network's base]");
    return {-1, 0.0, 0.0};
  }
  network::BusFault fault{read_bus(part[0], network, where, problems), number(part[1], where, problems),
                          number(part[2], where, problems)};
  if (part.size() == 5) fault.z = {number(part[3], where, problems), number(part[4], where, problems)};
  if (fault.t_off > t_end)
    problems.add(
        fmt::format("a fault that ends at {:g} s, after the end of the run at {:g} s", fault.t_off, t_end),
        where, "the run would not contain its clearing", "shorten the fault or increase --t-end");
  return fault;
}

std::vector<network::LineTrip> read_line_trip(const std::string& text, const network::Network& network,
                                              double t_end, const std::string& where, Problems& problems) {
  const auto part = fields(text, 4, 6, "FROM:TO:CKT:T_OPEN[:T_CLOSE], or FROM:TO:THIRD:CKT:T_OPEN[:T_CLOSE]",
                           where, problems);
  if (part.empty()) return {};
  const std::vector<int> pair = branches_named({part[0], part[1]}, part[2], network),
                         three = part.size() == 4
                                     ? std::vector<int>{}
                                     : branches_named({part[0], part[1], part[2]}, part[3], network);
  const bool whole = part.size() == 6 || (part.size() == 5 && pair.empty() && !three.empty());
  if (part.size() == 5 && !pair.empty() && !three.empty())
    problems.add(fmt::format("both a branch {}-{} circuit {} and a transformer {}-{}-{} circuit {}", part[0],
                             part[1], part[2], part[0], part[1], part[2], part[3]),
                 where, "the text fits both",
                 "for the transformer, append T_CLOSE; for the branch, give T_OPEN alone");
  if (!whole && pair.size() > 1)
    problems.add(fmt::format("{} transformers {}-{} circuit {}", pair.size(), part[0], part[1], part[2]),
                 where, "each has another third bus", "add the third bus: FROM:TO:THIRD:CKT:T_OPEN");
  const std::vector<int>& branches = whole ? three : pair;
  const std::size_t times = whole ? 4 : 3;
  if (branches.empty()) {
    bool known = true;
    for (std::size_t i = 0; i + 1 < times; ++i)
      known = read_bus(part[i], network, where, problems) >= 0 && known;
    if (known)
      problems.add(fmt::format("no branch {} circuit {}",
                               fmt::join(part.begin(), part.begin() + static_cast<long>(times) - 1, "-"),
                               part[times - 1]),
                   where, network.origin + " has no branch of that name",
                   "give a branch of that file with its circuit id");
  }
  const double open = number(part[times], where, problems);
  std::optional<double> close;
  if (part.size() > times + 1) close = number(part[times + 1], where, problems);
  if (std::max(open, close.value_or(0.0)) > t_end)
    problems.add(fmt::format("switching after the run's end at {} s", t_end), where,
                 "the switching would be ignored", "choose earlier times or increase --t-end");
  std::vector<network::LineTrip> trips;
  for (const int branch : branches) trips.push_back({branch, open, close});
  return trips;
}

Complex read_impedance(const std::string& text, const std::string& where, Problems& problems) {
  const auto part = fields(text);
  if (part.size() == 2) return {number(part[0], where, problems), number(part[1], where, problems)};
  problems.add("'" + text + "' is not an impedance", where, "the form is R:X",
               "give both, in pu on the network's base");
  return {};
}

network::GeneratorTrip read_generator_trip(const std::string& text, const network::Network& network,
                                           double t_end, const std::string& where, Problems& problems) {
  const auto part =
      fields(text, 2, 3, "BUS[/ID]:T[:PART], T in s, PART a fraction of the units", where, problems);
  if (part.empty()) return {-1, 0.0};
  const int generator = generator_named(network, part[0], where, problems);
  const double t = event_time(part[1], t_end, where, problems);
  return {generator, t, part.size() == 3 ? number(part[2], where, problems) : 1.0};
}

network::LoadStep read_load_step(const std::string& text, const network::Network& network, double t_end,
                                 const std::string& where, Problems& problems) {
  network::LoadStep step{-1, {}, 0.0, {}};
  const auto part = fields(text, 4, 5, "BUS:P:Q:T_ON[:T_OFF] in MW, Mvar and s", where, problems);
  if (part.empty()) return step;
  step.bus = read_bus(part[0], network, where, problems);
  const double p = number(part[1], where, problems), q = number(part[2], where, problems);
  step.power = Complex(p, q) / network.base_mva;
  step.t_on = event_time(part[3], t_end, where, problems);
  if (part.size() == 5) step.t_off = event_time(part[4], t_end, where, problems);
  return step;
}

network::SetpointStep read_setpoint_step(const std::string& text, const network::Network& network,
                                         double t_end, bool voltage, const std::string& where,
                                         Problems& problems) {
  const auto part = fields(text, 3, 3, "BUS[/ID]:T:STEP in s and pu", where, problems);
  if (part.empty()) return {-1, 0.0, 0.0, 0.0};
  const int generator = generator_named(network, part[0], where, problems);
  const double t = event_time(part[1], t_end, where, problems), step = number(part[2], where, problems);
  return {generator, t, voltage ? step : 0.0, voltage ? 0.0 : step};
}

}  // namespace swingbank::sim::formats
