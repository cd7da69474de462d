// Choice of a file's columns: by the user's column map, by their headings, from one terminal or two
// complementary ones.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <utility>

#include "validate/record/detail/build.hpp"
#include "validate/record/detail/phases.hpp"
#include "validate/record/detail/text.hpp"

namespace swingbank::validate::record {
namespace {

using Present = std::array<bool, kQuantities>;
using enum Quantity;

bool has(const Present& present, Quantity q) { return present[static_cast<std::size_t>(q)]; }

/// Returns the lists of alternative quantities (ReadOptions::needed) of which the file contains none.
std::vector<std::vector<Quantity>> missing_lists(const Present& present, const ReadOptions& options) {
  std::vector<std::vector<Quantity>> all;
  for (const auto& words : options.needed) {
    std::vector<Quantity> any;
    for (const auto& word : words)
      if (const auto m = quantity_of(word)) any.push_back(m->quantity);
    if (std::ranges::none_of(any, [&](Quantity q) { return has(present, q); })) all.push_back(any);
  }
  return all;
}

/// Returns the missing quantities that a comparison requires. P and Q, if required, may be computed from the
/// current, and the angle from the frequency.
std::vector<Quantity> missing(const Present& present, const ReadOptions& options) {
  std::vector<Quantity> all;
  if (!has(present, time)) all.push_back(time);
  if (options.part) return all;
  if (options.component != Component::plant) {
    for (const auto& any : missing_lists(present, options)) all.push_back(any.front());
    return all;
  }
  if (!has(present, V)) all.push_back(V);
  if (options.angle && !has(present, theta)) all.push_back(theta);
  if (!options.power || (has(present, I) && has(present, phi) && has(present, theta))) return all;
  for (const auto q : {P, Q})
    if (!has(present, q)) all.push_back(q);
  return all;
}

/// Returns whether a column of terminal `of` belongs to terminal `chosen`: the column has no terminal, the
/// same one, or that of equipment that contains `chosen` ("PLANT" contains "PLANT.GSU", "32" contains
/// "32/1").
bool belongs(const std::string& of, const std::string& chosen) {
  if (of.empty() || of == chosen) return true;
  return chosen.starts_with(of) && (chosen[of.size()] == '.' || chosen[of.size()] == '/');
}

Present present_in(const std::vector<Heading>& headings, const std::string& terminal) {
  Present present{};
  for (const auto& h : headings)
    if (h.meaning && belongs(h.meaning->terminal, terminal))
      present[static_cast<std::size_t>(h.meaning->quantity)] = true;
  return present;
}

std::string listed(const std::set<std::string>& names) {
  std::string all;
  for (const auto& n : names) all += (all.empty() ? "" : ", ") + n;
  return all;
}

/// Returns all headings, to show the user the possible names; a long list is truncated.
std::string seen(const std::vector<Heading>& headings) {
  constexpr std::size_t kHeadingsShown = 40;
  std::string all;
  std::size_t shown = 0, rest = 0;
  for (const auto& h : headings) {
    if (h.name.empty()) continue;
    if (shown++ < kHeadingsShown)
      all += (all.empty() ? "'" : ", '") + h.name + (h.unit.empty() ? "'" : "' [" + h.unit + "]");
    else
      ++rest;
  }
  return all + (rest > 0 ? fmt::format(" and {} more", rest) : "");
}

/// Terminals of the voltage and of the power, usually the same.
struct Terminals {
  std::string voltage, power;
  bool frequency_of_power = false;  ///< the voltage's terminal has no frequency
  [[nodiscard]] const std::string& of(Quantity q) const {
    if (q == f) return frequency_of_power ? power : voltage;
    return q == V || q == theta || q == time ? voltage : power;
  }
};

/// Returns two terminals if none is complete: the only one with a voltage, and the only one with P and Q or
/// with the current.
std::optional<Terminals> two_devices(const std::vector<Heading>& headings, const std::set<std::string>& all) {
  std::set<std::string> voltage, power;
  const Present nameless = present_in(headings, {});
  for (const auto& t : all) {
    const Present p = present_in(headings, t);
    if (!has(nameless, V) && has(p, V)) voltage.insert(t);
    const bool known = (has(nameless, P) && has(nameless, Q)) || (has(nameless, I) && has(nameless, phi));
    if (!known && ((has(p, P) && has(p, Q)) || (has(p, I) && has(p, phi)))) power.insert(t);
  }
  if (voltage.size() > 1 || power.size() > 1) return std::nullopt;
  Terminals both{voltage.empty() ? "" : *voltage.begin(), power.empty() ? "" : *power.begin(), false};
  both.frequency_of_power = !has(present_in(headings, both.voltage), f);
  return both;
}

/// Returns the terminal to read: the requested one, an empty name if the columns without a terminal are
/// complete, the only complete terminal, or two that complete each other.
Terminals choose_terminals(const std::vector<Heading>& headings, const ReadOptions& options,
                           const std::string& where, Record& about, Problems& problems) {
  const std::string& asked = options.terminal;
  std::set<std::string> all, complete;
  for (const auto& h : headings)
    if (h.meaning && !h.meaning->terminal.empty()) all.insert(h.meaning->terminal);
  if (!asked.empty()) {
    if (!all.contains(asked))
      problems.add("no terminal '" + asked + "'", where,
                   all.empty() ? "the file names no terminals" : "the file has " + listed(all),
                   all.empty() ? "remove '#" + asked + "' from the file name" : "choose one of them");
    return {asked, asked, false};
  }
  if (options.part && all.size() == 1) return {*all.begin(), *all.begin(), false};
  if (all.empty() || missing(present_in(headings, {}), options).empty()) return {};
  for (const auto& t : all)
    if (missing(present_in(headings, t), options).empty()) complete.insert(t);
  std::erase_if(complete, [&](const std::string& t) {  // keep equipment, not its parts
    return std::ranges::any_of(complete, [&](const auto& o) { return o != t && belongs(o, t); });
  });
  if (complete.size() > 1)
    problems.add("several terminals", where, "the file has " + listed(complete),
                 "choose one: FILE#" + *complete.begin());
  if (!complete.empty()) return {*complete.begin(), *complete.begin(), false};
  if (const auto both = two_devices(headings, all)) {
    if (both->voltage != both->power && !both->voltage.empty() && !both->power.empty() && options.power)
      about.notes.push_back(
          fmt::format("Voltage was read from terminal {}, power from terminal {}: only these provide them.",
                      both->voltage, both->power));
    return *both;
  }
  if (!options.part)
    problems.add("no complete terminal", where,
                 "none of the terminals " + listed(all) + " has voltage" +
                     (options.power ? ", P and Q (or current and its angle)" : " and time") +
                     ", and it is ambiguous which of them belong together; columns found: " + seen(headings),
                 "name the columns: --columns V=…,P=…,Q=… or [record.columns] in the plant file");
  return {*all.begin(), *all.begin(), false};
}

void check_missing(const Present& present, const ReadOptions& options, const std::string& where,
                   const std::vector<Heading>& headings, Problems& problems) {
  if (options.component != Component::plant && !options.part) {
    for (const auto& any : missing_lists(present, options)) {
      std::string names;
      for (const auto q : any) names += (names.empty() ? "" : " or ") + names_of(q);
      problems.add("no column " + names, where,
                   fmt::format("the {} needs it for playback or comparison; columns found: {}",
                               component_name(options.component), seen(headings)),
                   "add the column, named with its unit, or say which one it is: --columns " +
                       std::string(word_of(any.front())) + "=… or [record.columns] in the plant file");
    }
    if (has(present, time)) return;
  }
  for (const auto q : missing(present, options.component == Component::plant || options.part
                                           ? options
                                           : ReadOptions{.power = false, .part = true}))
    problems.add(
        "no column " + names_of(q), where,
        std::string(options.power ? "play-in needs time, voltage, P and Q, and the angle or the frequency"
                                  : "a comparison needs time, voltage and angle") +
            "; columns found: " + seen(headings),
        "add the column, named with its unit, or say which one it is: --columns V=…,P=… or "
        "[record.columns] in the plant file");
}

/// Returns the index of the heading that the user's text identifies. The text is "#3" (the third column), the
/// heading, "TERMINAL.HEADING", or the heading in another case or with other blanks.
std::optional<std::size_t> find_heading(const std::vector<Heading>& headings, std::string_view text) {
  if (std::size_t n = 0; text.starts_with('#')) {
    const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), n);
    if (error == std::errc{} && end == text.data() + text.size() && n >= 1 && n <= headings.size())
      return n - 1;
  }
  const auto find = [&](auto same) -> std::optional<std::size_t> {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < headings.size(); ++i)
      if (same(headings[i])) {
        if (found) return std::nullopt;  // two headings match
        found = i;
      }
    return found;
  };
  if (const auto i = find([&](const Heading& h) { return trimmed(h.name) == text; })) return i;
  if (const auto i =
          find([&](const Heading& h) { return h.meaning && h.meaning->terminal + "." + h.name == text; }))
    return i;
  if (text.starts_with('-')) return std::nullopt;  // reversed sign, which the caller removes
  return find([&](const Heading& h) { return !h.name.empty() && normalised(h.name) == normalised(text); });
}

/// Parts of "NAME [kV]".
struct Named {
  std::string_view name, unit;
  bool negated = false;
};
Named without_unit(Named named) {
  if (!named.name.ends_with(']')) return named;
  const auto open = named.name.rfind('[');
  if (open == std::string_view::npos || open == 0) return named;
  return {trimmed(named.name.substr(0, open)), named.name.substr(open + 1, named.name.size() - open - 2),
          named.negated};
}

/// Sets the meaning of the columns named by the user, and clears it in other columns of the same quantity.
class Mapper {
 public:
  Mapper(std::vector<Heading>& headings, const ReadOptions& options, const std::string& where, Record& about,
         Problems& problems)
      : headings_(headings), options_(options), where_(where), about_(about), problems_(problems) {}

  void apply() {
    std::vector<std::pair<std::size_t, ColumnMeaning>> all;
    for (const auto& [word, text] : options_.columns)
      if (const auto one = resolve(word, text)) all.push_back(*one);
    for (const auto& [at, m] : all)
      for (std::size_t i = 0; i < headings_.size(); ++i)
        if (headings_[i].meaning && headings_[i].meaning->quantity == m.quantity)
          headings_[i].meaning.reset();
    for (auto& [at, m] : all) headings_[at].meaning = m;
  }

 private:
  std::optional<std::pair<std::size_t, ColumnMeaning>> resolve(const std::string& word,
                                                               const std::string& text) {
    auto m = quantity_of(word);
    if (!m) {
      problems_.add("'" + word + "'", "--columns or [record.columns]", "a record has no such quantity",
                    "use t, V, theta, f, P, Q, I, phi, speed, omega, Efd, Ifd, Vs, Vref, Pm, Pref or "
                    "gate");
      return std::nullopt;
    }
    Named named{trimmed(text), {}, false};
    auto at = find_heading(headings_, named.name);
    if (!at) at = find_heading(headings_, (named = without_unit(named)).name);
    if (!at && named.name.starts_with('-')) {
      named = without_unit({trimmed(trimmed(text).substr(1)), {}, true});
      at = find_heading(headings_, named.name);
    }
    if (!at) {
      if (!options_.part)
        problems_.add(fmt::format("no column '{}'", named.name), where_,
                      fmt::format("--columns or [record.columns] assigns it to {}; columns found: {}", word,
                                  seen(headings_)),
                      "name one of them; if two columns have the same name, add the terminal");
      return std::nullopt;
    }
    const Heading& h = headings_[*at];
    const bool same = h.meaning && h.meaning->quantity == m->quantity;
    m->unit = named.unit.empty() && same && h.meaning->unit ? h.meaning->unit
                                                            : unit_in(m->quantity, h.name, h.unit);
    if (!named.unit.empty()) m->unit = unit_in(m->quantity, {}, named.unit);
    if (same && h.meaning->deviation) m->deviation = true;
    m->unknown_unit = !m->unit && (!named.unit.empty() || h.unknown_unit());
    m->negated = named.negated;
    if (!m->unit && (m->quantity != Quantity::time || m->unknown_unit))
      problems_.add(
          fmt::format("column '{}'", h.name), where_, "its unit is missing or not known",
          fmt::format("give it: {} = \"{} [unit]\", as in {}", word, h.name, names_of(m->quantity)));
    about_.named.push_back(word);
    about_.notes.push_back(fmt::format("{}{} is the column '{}', assigned by --columns or [record.columns].",
                                       word, named.negated ? ", with the sign reversed," : "", h.name));
    return std::pair(*at, *m);
  }

  std::vector<Heading>& headings_;
  const ReadOptions& options_;
  const std::string& where_;
  Record& about_;
  Problems& problems_;
};

/// Returns whether the column is the one of its quantity that belongs most closely to the terminal: a column
/// of "32/1" is preferred to one of "32".
bool is_nearest(const std::vector<Heading>& headings, const Heading& one, const Terminals& terminals) {
  const ColumnMeaning& m = *one.meaning;
  return std::ranges::none_of(headings, [&](const Heading& h) {
    return h.meaning && h.meaning->quantity == m.quantity &&
           belongs(h.meaning->terminal, terminals.of(m.quantity)) &&
           h.meaning->terminal.size() > m.terminal.size();
  });
}

/// Recognises headings with a terminal in front, without a dot: "GEN2 Voltage Magnitude (kV)", "gen2_P_MW".
/// Words in front are a terminal only if they stand before a voltage, P and Q, and the file has no other
/// voltage: "Rotor Angle" is no angle of a terminal "Rotor".
void recognise_terminals(std::vector<Heading>& headings) {
  if (std::ranges::any_of(headings, [](const Heading& h) { return h.meaning && h.meaning->quantity == V; }))
    return;
  std::map<std::string, std::map<std::size_t, ColumnMeaning>> found;  // by terminal and heading
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const std::string& name = headings[i].name;
    if (headings[i].meaning) continue;
    for (std::size_t at = name.find_first_of(" _-"); at != std::string::npos;
         at = name.find_first_of(" _-", at + 1))
      if (auto m = column_meaning(name.substr(at + 1), headings[i].unit); m && at > 0)
        found[name.substr(0, at)].emplace(i, *m);
  }
  for (const auto& [terminal, columns] : found) {
    const auto has = [&](Quantity q) {
      return std::ranges::any_of(columns, [&](const auto& c) { return c.second.quantity == q; });
    };
    if (!has(V) || !has(P) || !has(Q)) continue;
    for (auto [i, m] : columns) {
      m.terminal = terminal;
      headings[i].meaning = std::move(m);
    }
  }
}

}  // namespace

bool Heading::unknown_unit() const {
  const auto open = name.find_first_of("([");
  const std::string_view inside = !unit.empty()               ? std::string_view(unit)
                                  : open == std::string::npos ? std::string_view()
                                                              : std::string_view(name).substr(open + 1);
  return !normalised(inside).empty() && !is_clock_word(inside) && !is_unit(inside);
}

/// Returns whether the tested component requires the quantity.
static bool is_asked_for(Quantity q, const ReadOptions& options) {
  if (options.component == Component::plant) return true;
  return std::ranges::any_of(options.needed, [&](const auto& words) {
    return std::ranges::any_of(words, [&](const auto& word) {
      const auto m = quantity_of(word);
      return m && m->quantity == q;
    });
  });
}

std::vector<std::size_t> choose_columns(std::vector<Heading>& headings, const ReadOptions& options,
                                        const RecordBase& base, const std::string& where, Record& about,
                                        Problems& problems) {
  recognise_terminals(headings);
  if (options.component == Component::plant)
    for (auto& h : headings)
      if (h.meaning && is_inner(h.meaning->quantity)) h.meaning.reset();
  Mapper(headings, options, where, about, problems).apply();
  keep_needed_phases(headings);
  const Terminals terminals = choose_terminals(headings, options, where, about, problems);
  about.terminal = terminals.voltage == terminals.power || terminals.power.empty() ? terminals.voltage
                   : terminals.voltage.empty()                                     ? terminals.power
                                               : terminals.voltage + " and " + terminals.power;
  std::vector<std::size_t> chosen;
  std::set<std::string> others;
  Present used{};
  std::set<std::pair<std::size_t, std::size_t>> phases;
  for (std::size_t i = 0; i < headings.size(); ++i) {
    const auto& [name, meaning, unit] = headings[i];
    if (!meaning) {
      if (!name.empty()) about.ignored.push_back(name);
      continue;
    }
    if (!belongs(meaning->terminal, terminals.of(meaning->quantity)) ||
        !is_nearest(headings, headings[i], terminals)) {
      others.insert(meaning->terminal);
      continue;
    }
    const auto q = static_cast<std::size_t>(meaning->quantity);
    const bool given_by_user = std::ranges::any_of(
        about.named,
        [wanted = meaning->quantity](const auto& word) { return quantity_of(word)->quantity == wanted; });
    if (!meaning->unit && !given_by_user && !is_unit_in_values(headings[i]) &&
        (meaning->quantity != time || meaning->unknown_unit))
      problems.add(fmt::format("column '{}'", name), where, "its unit is missing or not known",
                   "name it one of " + names_of(meaning->quantity) + ", or give the unit: --columns \"" +
                       std::string(word_of(meaning->quantity)) + "=" + name + " [unit]\"");
    else if (meaning->unit && needs_kv(meaning->quantity, *meaning->unit) && !(base.kv > 0))
      problems.add(fmt::format("no base voltage for column '{}'", name), where,
                   "the plant file has no base_kv under [record]",
                   "add base_kv under [record] in the plant file, or give per-unit values");
    const auto key = meaning->unit ? needs_base(meaning->quantity, *meaning->unit) : "";
    if (!key.empty() && !((meaning->quantity == Efd ? base.efd : base.ifd) > 0)) {
      if (!is_asked_for(meaning->quantity, options)) {
        about.notes.push_back(fmt::format(
            "Column '{}' was not read: the plant file has no {} under [record], and the {} does not need it.",
            name, key, component_name(options.component)));
        continue;
      }
      problems.add(fmt::format("no base value for column '{}'", name), where,
                   "the plant file does not state its value at 1 pu (air-gap line)",
                   fmt::format("add {} = … [{}] under [record] in the plant file, or give per-unit values",
                               key, meaning->quantity == Efd ? "V" : "A"));
    }
    const bool again = used[q] && !meaning->phase;
    used[q] = true;
    if (again || (meaning->phase && !phases.emplace(q, meaning->phase->number).second))
      problems.add(fmt::format("repeated quantity in column '{}'", name), where,
                   "another column gives the same quantity",
                   "keep only one of " + names_of(meaning->quantity) + ", or choose one with --columns");
    chosen.push_back(i);
  }
  check_missing(used, options, where, headings, problems);
  others.erase("");
  if (!others.empty()) about.notes.push_back("Other terminals in the file: " + listed(others) + ".");
  return chosen;
}

}  // namespace swingbank::validate::record
