#include "validate/record/detail/phases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>

#include "base/complex.hpp"
#include "base/constants.hpp"
#include "base/median.hpp"
#include "validate/record/detail/phasor.hpp"

namespace swingbank::validate::record {
namespace {

bool is_current(Quantity q) { return q == Quantity::I || q == Quantity::phi; }

/// Returns the heading without the unit at its end.
std::string_view without_unit(std::string_view heading) {
  if (const auto open = heading.find_first_of("(["); open != std::string_view::npos && open > 0)
    return heading.substr(0, open);
  const auto at = heading.find_last_of("_ /-,");
  // "Va_a" is an angle, and "Va_A" is not in amperes: a single letter is not accepted as a unit here.
  if (at == std::string_view::npos || heading.size() - at <= 2 || !is_unit(heading.substr(at + 1)))
    return heading;
  return heading.substr(0, at);
}

/// Returns the text in lower case with one '_' for each separator of words. Thus "VB_A" differs from "VBA".
std::string parted(std::string_view text) {
  std::string all;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)))
      all += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (!all.empty() && all.back() != '_')
      all += '_';
  if (all.ends_with('_')) all.pop_back();
  return all;
}

double median_finite(const std::vector<double>& values) {
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  return finite.empty() ? kNoValue : upper_median(std::move(finite));
}

/// Columns of one quantity by phase; nullptr if a phase was not recorded.
using Three = std::array<RawColumn*, 3>;
Three three_of(RawRecord& raw, Quantity q) {
  Three all{};
  for (RawColumn& c : raw.columns)
    if (c.meaning.quantity == q && c.meaning.phase) all[c.meaning.phase->number] = &c;
  return all;
}
bool none_of(const Three& columns) { return std::ranges::count(columns, nullptr) == 3; }
const RawColumn& first_of(const Three& columns) {
  return **std::ranges::find_if(columns, [](const RawColumn* c) { return c != nullptr; });
}

[[noreturn]] void refuse_unit(const RawColumn& column, const std::string& file, const std::string& why) {
  throw InputError({fmt::format("no unit for column '{}'", column.name), file,
                    "its unit is missing, and " + why, "name it with its unit, as in Va_kV, Va_deg, Ia_A"});
}

class Combination {
 public:
  Combination(RawRecord& raw, const RecordBase& base, const std::string& file)
      : raw_(raw), base_(base), file_(file) {}

  void run() {
    for (RawColumn& c : raw_.columns)
      if (c.meaning.quantity == Quantity::f && !c.meaning.unit) settle_frequency(c);
    combine(Quantity::V, Quantity::theta);
    combine(Quantity::I, Quantity::phi);
    std::erase_if(raw_.columns, [](const RawColumn& c) { return c.meaning.phase.has_value(); });
  }

 private:
  void settle_frequency(RawColumn& c) {
    const double middle = median_finite(c.values);
    if (std::abs(middle / base_.frequency - 1) < 0.2)
      c.meaning.unit = Unit::hertz;
    else if (std::abs(middle - 1) < 0.2)
      c.meaning.unit = Unit::pu;
    else
      refuse_unit(c, file_, fmt::format("{:.4g} is near neither {:g} Hz nor 1 pu", middle, base_.frequency));
    raw_.about.notes.push_back(fmt::format("The column '{}' names no unit: its values indicate {}.", c.name,
                                           c.meaning.unit == Unit::hertz ? "Hz" : "per unit"));
  }

  /// Infers the unit of angles: two phases are 120 degrees apart in one unit only.
  Unit unit_of_angles(const Three& angles) {
    const RawColumn& one = first_of(angles);
    if (one.meaning.unit) return *one.meaning.unit;
    const auto other = std::ranges::find_if(angles, [&](const RawColumn* c) { return c && c != &one; });
    for (const Unit unit : {Unit::degree, Unit::radian}) {
      const double scale = unit == Unit::degree ? constants::degree : 1.0;
      Complex mean = 0;
      for (std::size_t k = 0; k < one.values.size(); ++k)
        if (const Complex x = std::polar(1.0, scale * (one.values[k] - (*other)->values[k]));
            std::isfinite(x.real()))
          mean += x;
      if (std::abs(std::abs(std::arg(mean)) - constants::turn / 3) > 0.3) continue;
      note_unit(one, unit == Unit::degree ? "degrees" : "radians");
      return unit;
    }
    refuse_unit(one, file_, "neither in degrees nor in radians are the phases 120 degrees apart");
  }

  /// Infers the unit of magnitudes: voltages are near the nominal one in one unit only, and currents have the
  /// corresponding unit.
  Unit unit_of_magnitudes(const Three& columns) {
    const RawColumn& one = first_of(columns);
    if (one.meaning.unit) return *one.meaning.unit;
    if (one.meaning.quantity == Quantity::I) {
      if (!of_voltage_) refuse_unit(one, file_, "the values of a current do not determine its unit");
      const Unit unit = *of_voltage_ == Unit::pu ? Unit::pu
                        : in_kilo(*of_voltage_)  ? Unit::kiloampere
                                                 : Unit::ampere;
      note_unit(one, unit == Unit::pu       ? "per unit"
                     : unit == Unit::ampere ? "A, as the voltages are in V"
                                            : "kA");
      return unit;
    }
    const double middle = median_finite(one.values);
    const bool between = one.meaning.phase->between;
    for (const Unit unit :
         {Unit::pu, between ? Unit::kilovolt : Unit::kilovolt_ln, between ? Unit::volt : Unit::volt_ln}) {
      if (unit != Unit::pu && !(base_.kv > 0)) continue;
      const double pu = to_record_units({Quantity::V, unit, false, {}, false}, middle, base_);
      if (!(std::abs(pu - 1) < 0.3)) continue;
      note_unit(one, unit == Unit::pu ? "per unit" : in_kilo(unit) ? "kV" : "V");
      return unit;
    }
    refuse_unit(one, file_,
                fmt::format("{:.5g} is near the nominal voltage neither in V nor in kV nor in pu", middle));
  }
  static bool in_kilo(Unit u) { return u == Unit::kilovolt || u == Unit::kilovolt_ln; }
  void note_unit(const RawColumn& c, const std::string& unit) {
    raw_.about.notes.push_back(fmt::format(
        "The column '{}' names no unit: the values of the three phases indicate {}.", c.name, unit));
  }

  void combine(Quantity magnitude, Quantity angle) {
    const Three sizes = three_of(raw_, magnitude), angles = three_of(raw_, angle);
    if (none_of(sizes) || none_of(angles)) return;
    const bool between = first_of(sizes).meaning.phase->between;
    const Unit size_unit = unit_of_magnitudes(sizes), angle_unit = unit_of_angles(angles);
    if (magnitude == Quantity::V && !first_of(sizes).meaning.unit) of_voltage_ = size_unit;
    std::array<std::vector<Complex>, 3> x;
    std::array<std::string, 3> names;
    for (std::size_t p = 0; p < 3; ++p) {
      if (!sizes[p]) continue;
      names[p] = sizes[p]->name;
      const double sign = sizes[p]->meaning.phase->reversed ? -1 : 1;
      for (std::size_t k = 0; k < sizes[p]->values.size(); ++k)
        x[p].push_back(sign *
                       to_record_units({magnitude, size_unit, false, {}, false}, sizes[p]->values[k], base_) *
                       std::polar(1.0, to_record_units({angle, angle_unit, false, {}, false},
                                                       angles[p]->values[k], base_)));
    }
    for (std::size_t p = 0; p < 3; ++p)
      if (!sizes[p]) {
        names[p] = "the computed phase";
        for (std::size_t k = 0; k < x[(p + 1) % 3].size(); ++k)
          x[p].push_back(-x[(p + 1) % 3][k] - x[(p + 2) % 3][k]);
      }
    if (const auto fault = sequence_fault(x, names))
      throw InputError({fault->what, file_, fault->why, fault->remedy});
    RawColumn size{names[0], {magnitude, Unit::pu, false, {}, false}, {}};
    RawColumn turned{first_of(angles).name, {angle, Unit::radian, false, {}, false}, {}};
    // The conversion to pu already handles line-to-line voltages, so the factor 1/sqrt(3) of
    // positive_sequence() is cancelled.
    const double back = between ? std::sqrt(3.0) : 1.0;
    for (std::size_t k = 0; k < x[0].size(); ++k) {
      const Complex one = back * positive_sequence({x[0][k], x[1][k], x[2][k]}, between);
      const bool given = std::isfinite(std::norm(one));
      size.values.push_back(given ? std::abs(one) : kNoValue);
      turned.values.push_back(given ? std::arg(one) : kNoValue);
    }
    raw_.about.notes.push_back(fmt::format("The {} is the positive sequence of the phasors {}, {}, {}.",
                                           magnitude == Quantity::V ? "voltage" : "current", names[0],
                                           names[1], names[2]));
    raw_.columns.push_back(std::move(size));
    raw_.columns.push_back(std::move(turned));
  }

  RawRecord& raw_;
  const RecordBase& base_;
  const std::string& file_;
  std::optional<Unit> of_voltage_;  ///< unit of the voltages, if inferred from their values
};

}  // namespace

std::optional<ColumnMeaning> phase_meaning(std::string_view heading, std::string_view unit) {
  static const std::string
      phase =
          "(l?[123]|l1_?l2|l2_?l3|l3_?l1|l12|l23|l31|ab|bc|ca|ba|cb|ac|rs|st|tr|uv|vw|wu|[abcrstuvw][ng]|[abcrstuvw])",
      quantity = "(voltage|volt|v|u|e|current|i)", end = "(?:_?(magnitude|mag|m|rms|pm)|_?(angle|ang|a|pa))?",
      middle = "_?(?:(magnitude|mag|rms)|(angle|ang))", of_phase = "_?(?:phase|ph)?_?";
  struct Form {
    std::regex form;
    std::size_t quantity, phase, size, turned;
  };
  static const Form forms[] = {{std::regex(quantity + of_phase + phase + end), 1, 2, 3, 4},
                               {std::regex("(?:phase|ph)_?" + phase + "_?" + quantity + end), 2, 1, 3, 4},
                               {std::regex(quantity + middle + of_phase + phase), 1, 4, 2, 3}};
  const std::string name = parted(without_unit(heading));
  std::smatch part;
  const auto form =
      std::ranges::find_if(forms, [&](const Form& f) { return std::regex_match(name, part, f.form); });
  if (form == std::end(forms)) return std::nullopt;
  const auto of = phase_of(part[form->phase].str());
  const std::string word = part[form->quantity].str();
  const bool current = word == "current" || word == "i";
  const bool sized = part[form->size].matched, angled = part[form->turned].matched;
  // "V1" is the positive sequence.
  if (!of || (current && of->between) || std::isdigit(static_cast<unsigned char>(part[form->phase].str()[0])))
    return std::nullopt;
  const Quantity magnitude = current ? Quantity::I : Quantity::V,
                 angle = current ? Quantity::phi : Quantity::theta;
  const bool turns =
      angled || (!sized && unit_in(angle, heading, unit) && !unit_in(magnitude, heading, unit));
  const bool bare = without_unit(heading).size() == heading.size();
  const auto named = unit_in(turns ? angle : magnitude, bare ? "" : heading, unit);
  if (!sized && !angled && !named) return std::nullopt;  // "Va" alone is ambiguous
  ColumnMeaning m{turns ? angle : magnitude, named, false, {}, false};
  if (!of->between && m.unit == Unit::kilovolt) m.unit = Unit::kilovolt_ln;
  if (!of->between && m.unit == Unit::volt) m.unit = Unit::volt_ln;
  m.phase = of;
  return m;
}

void keep_needed_phases(std::vector<Heading>& headings) {
  struct Terminal {
    std::map<Quantity, std::map<bool, std::set<std::size_t>>> phases;  ///< inner key: whether line to line
    std::set<Quantity> whole;
  };
  std::map<std::string, Terminal> terminals;
  for (const Heading& h : headings)
    if (h.meaning && h.meaning->phase)
      terminals[h.meaning->terminal].phases[h.meaning->quantity][h.meaning->phase->between].insert(
          h.meaning->phase->number);
  for (const Heading& h : headings)
    if (h.meaning && !h.meaning->phase)
      for (auto& [name, t] : terminals)
        if (h.meaning->terminal.empty() || h.meaning->terminal == name) t.whole.insert(h.meaning->quantity);
  for (Heading& h : headings) {
    if (!h.meaning || !h.meaning->phase) continue;
    Terminal& t = terminals[h.meaning->terminal];
    const bool current = is_current(h.meaning->quantity), between = h.meaning->phase->between;
    const Quantity size = current ? Quantity::I : Quantity::V,
                   angle = current ? Quantity::phi : Quantity::theta;
    const auto complete = [&](bool pairs) {
      const auto &a = t.phases[size][pairs], &b = t.phases[angle][pairs];
      return a == b && a.size() >= (pairs || current ? 2U : 3U);
    };
    const bool given =
        t.whole.contains(size) || (current && t.whole.contains(Quantity::P) && t.whole.contains(Quantity::Q));
    if (given || !complete(between) || (between && complete(false))) h.meaning.reset();
  }
}

bool is_unit_in_values(const Heading& h) {
  return h.meaning && (h.meaning->phase || (h.meaning->quantity == Quantity::f && !h.meaning->unknown_unit));
}

void combine_phases(RawRecord& raw, const RecordBase& base, const std::string& file) {
  Combination(raw, base, file).run();
}

}  // namespace swingbank::validate::record
