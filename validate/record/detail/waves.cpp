#include "validate/record/detail/waves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "validate/record/detail/columns.hpp"

namespace swingbank::validate::record {
namespace {

constexpr std::string_view kVoltageLetters = "vue";

bool is_quantity(std::string_view word, bool voltage) {
  if (word.size() == 1)
    return voltage ? kVoltageLetters.find(word[0]) != std::string_view::npos : word == "i";
  return voltage ? word == "volt" || word == "volts" || word == "voltage"
                 : word == "current" || word == "amps";
}

/// Alphanumeric words of a name: "VA_G1" gives "va", "g1", and each as written.
struct NameParts {
  std::vector<std::string> lower, written;
};
NameParts parts_of_name(std::string_view text) {
  NameParts all;
  bool inside = false;
  for (const char c : text) {
    const bool part = std::isalnum(static_cast<unsigned char>(c)) || static_cast<unsigned char>(c) >= 0x80;
    if (part && !inside) all.lower.emplace_back(), all.written.emplace_back();
    if (part) {
      all.lower.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      all.written.back() += c;
    }
    inside = part;
  }
  return all;
}

struct Named {
  Phase phase;
  std::string circuit;
};
/// Returns the circuit: all words, with those from `first` to `end` - 1 replaced by `rest`.
std::string other_words(const NameParts& words, std::size_t first, std::size_t end,
                        const std::string& rest = {}) {
  std::string all;
  for (std::size_t k = 0; k < words.written.size(); ++k) {
    const std::string& word = k == first ? rest : words.written[k];
    if ((k == first || k < first || k >= end) && !word.empty()) all += (all.empty() ? "" : " ") + word;
  }
  return all;
}

/// Returns whether the word denotes phasors, whose channels are not waveforms.
bool is_of_phasors(const std::string& word) {
  return word.starts_with("mag") || word.starts_with("ang") || word == "rms" || word == "pm" || word == "pa";
}

/// Finds phase and circuit in a channel's name: "VA_G1", "G1 VA", "G1-V-A", "VA1", "G1VA". If the phase is
/// `known`, only this phase is accepted. If it is not, a numeric phase is accepted only in a name of one
/// word, because "V1" beside other words may be the positive sequence.
std::optional<Named> named_in(std::string_view id, bool voltage, const std::optional<Phase>& known) {
  const NameParts words = parts_of_name(id);
  const std::size_t n = words.lower.size();
  if (std::ranges::any_of(words.lower, is_of_phasors)) return std::nullopt;
  const auto fits = [&](std::string_view text) -> std::optional<Phase> {
    if (!known && n > 1 && text.size() == 1 && std::isdigit(static_cast<unsigned char>(text[0])))
      return std::nullopt;
    const auto phase = phase_of(text);
    return phase && (!known || *phase == *known) ? phase : std::nullopt;
  };
  // Without a known phase, "VBUS" is not phase B: only a digit or a last letter from w to z may follow the
  // phase.
  const auto may_follow = [&](std::string_view rest) {
    return known || std::isdigit(static_cast<unsigned char>(rest[0])) || (rest.size() == 1 && rest[0] >= 'w');
  };
  for (std::size_t k = 0; k < n; ++k) {  // "va", or "v" and "a"
    const std::string& word = words.lower[k];
    if (word.size() > 1 && is_quantity(word.substr(0, 1), voltage))
      if (const auto phase = fits(std::string_view(word).substr(1)))
        return Named{*phase, other_words(words, k, k + 1)};
    if (k + 1 < n && is_quantity(word, voltage))
      if (const auto phase = fits(words.lower[k + 1])) return Named{*phase, other_words(words, k, k + 2)};
  }
  for (std::size_t k = 0; k < n; ++k) {  // "vag1", "g1va": the longest phase first
    const std::string &word = words.lower[k], &written = words.written[k];
    for (std::size_t length = 4; length > 0; --length) {
      if (word.size() <= length + 1 || word[length] == 'g') continue;  // "VAG1" belongs to G1
      const std::string_view rest = std::string_view(word).substr(1 + length);
      if (is_quantity(word.substr(0, 1), voltage) && may_follow(rest))
        if (const auto phase = fits(std::string_view(word).substr(1, length)))
          return Named{*phase, other_words(words, k, k + 1, written.substr(1 + length))};
      const std::size_t at = word.size() - length - 1;
      if (std::isdigit(static_cast<unsigned char>(word[at - 1])) && is_quantity(word.substr(at, 1), voltage))
        if (const auto phase = fits(std::string_view(word).substr(at + 1)))
          return Named{*phase, other_words(words, k, k + 1, written.substr(0, at))};
    }
  }
  return std::nullopt;
}

/// Waves by phase, of one circuit or, if `circuit` is null, of all circuits.
struct Found {
  std::vector<const Wave*> phases[3], pairs[3];
};
/// Returns whether the phase has the letter A, B or C.
bool is_abc(const Wave* w) {
  const std::string phase = normalised(w->channel->phase), id = normalised(w->channel->id);
  const char letter = !phase.empty() ? phase[0] : id.size() > 1 ? id[1] : ' ';
  return letter >= 'a' && letter <= 'c';
}
Found found_in(const std::vector<Wave>& waves, bool voltage, const std::string* circuit) {
  Found found;
  for (const Wave& w : waves)
    if (w.voltage == voltage && (!circuit || w.circuit == *circuit))
      (w.phase.between ? found.pairs : found.phases)[w.phase.number].push_back(&w);
  // Relays name a synchronising voltage VS beside VA, VB, VC: where phases have the letters A, B, C, S is
  // none.
  for (auto& of : found.phases)
    if (const auto abc = std::ranges::find_if(of, is_abc);
        abc != of.end() && std::ranges::count_if(of, is_abc) == 1)
      std::erase_if(of, [kept = *abc](const Wave* w) { return w != kept && w->circuit == kept->circuit; });
  return found;
}

/// Returns a set of three waves, or of two if `two_are_enough` to determine the third. None if waves are
/// missing or a phase occurs twice.
std::optional<WaveSet> set_of(const std::vector<const Wave*> (&of)[3], bool two_are_enough, bool between,
                              const std::string& circuit) {
  WaveSet set{{}, between, circuit};
  std::size_t given = 0;
  for (std::size_t p = 0; p < 3; ++p) {
    if (of[p].size() > 1) return std::nullopt;
    if (!of[p].empty()) set.waves[p] = of[p].front(), ++given;
  }
  return given == 3 || (given == 2 && two_are_enough) ? std::optional(set) : std::nullopt;
}
std::optional<WaveSet> complete(const std::vector<Wave>& waves, bool voltage, const std::string* circuit) {
  const Found found = found_in(waves, voltage, circuit);
  const std::string name = circuit ? *circuit : "";
  if (auto set = set_of(found.phases, !voltage, false, name)) return set;
  return voltage ? set_of(found.pairs, true, true, name) : std::nullopt;
}

std::string seen(const std::vector<Wave>& waves, bool voltage) {
  std::string all;
  for (const Wave& w : waves)
    if (w.voltage == voltage) all += (all.empty() ? "" : ", ") + w.channel->id;
  return all;
}

}  // namespace

std::optional<Wave> wave_of(const ComtradeChannel& c) {
  const auto unit = find_unit(c.unit);
  const bool volt = unit == Unit::volt || unit == Unit::kilovolt,
             kilo = unit == Unit::kilovolt || unit == Unit::kiloampere;
  if (!volt && unit != Unit::ampere && unit != Unit::kiloampere) return std::nullopt;
  auto phase = phase_of(c.phase);
  const auto named = named_in(c.id, volt, phase);
  if (!phase && named) phase = named->phase;
  if (!phase || (!volt && phase->between)) return std::nullopt;
  return Wave{&c, volt, *phase, c.component.empty() && named ? named->circuit : c.component,
              kilo ? 1.0 : 1e-3};
}

std::optional<WaveSet> choose_waves(const std::vector<Wave>& waves, bool voltage, const ReadOptions& options,
                                    const std::string& where, Problems& problems) {
  const char* const kind = voltage ? "voltage" : "current";
  const std::string asked = normalised(options.terminal);
  std::set<std::string> circuits;
  bool incomplete = false;  // whether the requested circuit is incomplete
  for (const Wave& w : waves)
    if (w.voltage == voltage) circuits.insert(w.circuit);
  std::vector<WaveSet> sets;
  for (const std::string& circuit : circuits) {
    const auto set = complete(waves, voltage, &circuit);
    const bool wanted = !asked.empty() && normalised(circuit) == asked;
    if (set && wanted) return set;
    if (set) sets.push_back(*set);
    incomplete = incomplete || wanted;
  }
  if (incomplete) sets.clear();
  // Three phases have priority over two of another circuit, whose third phase is only inferred.
  const auto whole = [](const WaveSet& s) { return std::ranges::count(s.waves, nullptr) == 0; };
  if (std::ranges::any_of(sets, whole)) std::erase_if(sets, [&](const WaveSet& s) { return !whole(s); });
  if (sets.empty() && !incomplete)
    if (const auto set = complete(waves, voltage, nullptr)) sets.push_back(*set);
  if (sets.size() == 1) return sets.front();
  if (!sets.empty()) {
    std::string names;
    for (const WaveSet& s : sets) names += (names.empty() ? "" : ", ") + s.circuit;
    problems.add(fmt::format("several three-phase {}s", kind), where, "their circuits are " + names,
                 "choose one: FILE#CIRCUIT");
  } else {
    problems.add(
        fmt::format("no three-phase {}", kind), where,
        fmt::format("it needs one channel for each of the phases A, B and C{}; the {}s are {}",
                    voltage ? ", or two of AB, BC and CA, in V or kV" : ", or two of them, in A or kA", kind,
                    seen(waves, voltage)),
        "export the missing channels, or name circuit and phase of each channel in the .cfg");
  }
  return std::nullopt;
}

}  // namespace swingbank::validate::record
