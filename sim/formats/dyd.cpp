#include "sim/formats/dyd.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "base/capitals.hpp"
#include "sim/formats/detail/dyd_models.hpp"
#include "sim/formats/detail/pslf_text.hpp"
#include "sim/formats/psse_text.hpp"

namespace swingbank::sim::formats {
namespace {

using pslf::Line;
using pslf::lower;
using pslf::Token;
using psse::trimmed;

const dyd::Model* model_of(std::string_view name) {
  const auto all = dyd::models();
  const auto at = std::ranges::find(all, name, &dyd::Model::dyd);
  return at == all.end() ? nullptr : &*at;
}

class DydReader {
 public:
  DydReader(std::vector<std::string> lines, std::string name) : name_(std::move(name)) { join(lines); }

  DydSurvey survey() {
    for (const Line& line : lines_) machine_base(line);
    for (const Line& line : lines_) record(line);
    out_.dyr.faults = problems_.list();
    return std::move(out_);
  }

 private:
  using Key = std::pair<int, std::string>;
  [[nodiscard]] std::string where(int line) const { return name_ + ":" + std::to_string(line); }

  void join(const std::vector<std::string>& lines) {
    for (std::size_t at = 0; at < lines.size();) {
      if (pslf::says_nothing(lines[at]))
        ++at;
      else
        lines_.push_back(pslf::record_at(lines, at, lines.size(), name_, problems_));
    }
  }

  /// Returns bus and id of a unit's record, which begins with: model, bus, name, kV, id.
  [[nodiscard]] static std::optional<Key> key_of(const Line& line) {
    if (!line.colon || line.head.size() < 5) return std::nullopt;
    const auto bus = psse::parse_number(line.head[1].text);
    if (!bus || *bus != std::floor(*bus) || std::abs(*bus) > 1e9L) return std::nullopt;
    const std::string id = trimmed(line.head[4].text);
    return Key{static_cast<int>(*bus), id.empty() ? "1" : id};
  }
  /// Returns the value of "mva=" or "mwcap=" [MVA, MW].
  [[nodiscard]] static std::optional<double> base_of(const Line& line) {
    for (const Token& token : line.tail)
      if (const auto cut = token.text.find('='); !token.quoted && cut != std::string::npos)
        if (const auto v = psse::parse_number(token.text.substr(cut + 1))) return static_cast<double>(*v);
    return std::nullopt;
  }

  void machine_base(const Line& line) {
    if (line.head.empty()) return;
    const dyd::Model* model = model_of(lower(line.head[0].text));
    const auto key = key_of(line);
    const auto mva = base_of(line);
    if (model && key && mva && model->base == "mva") mva_[*key] = *mva;
  }

  void record(const Line& line) {
    if (line.head.empty()) return;
    const std::string name = lower(line.head[0].text);
    const dyd::Model* model = model_of(name);
    if (dyd::is_no_unit(name)) {
      ++out_.passed_over[name];
      return;
    }
    const auto key = key_of(line);
    if (!key) {  // a section keyword, or a record between two buses
      if (model)
        problems_.add("a record without bus and id", where(line.number),
                      "the form is: model bus \"name\" kV \"id\" : values",
                      "give the bus by its number, and a ':' before the values");
      return;
    }
    DyrRecord out{key->first, capitals(name), key->second, {}, line.number};
    out_.names[line.number] = out.model;
    if (!model) {
      for (const Token& token : line.tail)
        if (const auto v = psse::parse_number(token.text); v && !token.quoted)
          out.values.push_back(static_cast<double>(*v));
      // PSS/E's model of the same name may have other columns or another order of columns.
      out.faults.add(
          fmt::format("no counterpart of PSLF's model {}", name), where(line.number),
          "Swingbank has no table of its columns; these models can be read: " + dyd_models_text(),
          "leave it out with --ignore-model (of one unit: --drop), or map it with --map-model (--replace) "
          "to a model with as many parameters");
      out_.dyr.records.push_back(std::move(out));
      return;
    }
    out.model = model->dyr;
    convert(*model, line, out);
    out_.dyr.records.push_back(std::move(out));
  }

  /// Returns the values in the model's column order; a missing one is Column::off.
  std::vector<double> values_of(const dyd::Model& model, const Line& line, Problems& faults) const {
    std::vector<double> values(model.in.size(), std::nan(""));
    std::size_t next = 0;
    bool named = false;
    for (std::size_t i = 0; i < line.tail.size(); ++i) {
      const Token& token = line.tail[i];
      if (!token.quoted && (token.text.starts_with('#') || token.text.find('=') != std::string::npos))
        continue;
      std::size_t at = next;
      const Token* number = &token;
      if (token.quoted) {
        named = true;
        const std::string column = lower(trimmed(token.text));
        const auto found = std::ranges::find(model.in, column, &dyd::Column::name);
        if (found == model.in.end()) {
          faults.add(fmt::format("unknown column {} of {}", column, model.dyd), where(line.number),
                     "it is not among the documented columns of the model",
                     "remove it, or leave the model out with --drop");
          ++i;
          continue;
        }
        at = static_cast<std::size_t>(found - model.in.begin());
        if (++i < line.tail.size()) number = &line.tail[i];
      } else {
        ++next;
      }
      const auto v = number->quoted ? std::nullopt : psse::parse_number(number->text);
      if (!v)
        faults.add(fmt::format("'{}' of {}", number->text, model.dyd), where(line.number),
                   "it is not a number", "correct the record");
      else if (at < values.size())
        values[at] = static_cast<double>(*v);
    }
    check_count(model, line, values, named, next, faults);
    return values;
  }
  void check_count(const dyd::Model& model, const Line& line, std::vector<double>& values, bool named,
                   std::size_t unnamed, Problems& faults) const {
    if (unnamed > 0 && !model.in_order) {
      faults.add(fmt::format("{} has values without names", model.dyd), where(line.number),
                 "the order of its values is not publicly documented", "write each value after its name");
      return;
    }
    if (unnamed > values.size())
      faults.add(fmt::format("{} with {} values", model.dyd, unnamed), where(line.number),
                 fmt::format("the model has {}", values.size()), "remove the surplus values");
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isnan(values[i])) continue;
      const dyd::Column& column = model.in[i];
      const bool may_lack = column.use == dyd::Use::off || column.use == dyd::Use::open ||
                            column.use == dyd::Use::free || column.use == dyd::Use::again;
      if (!may_lack)
        faults.add(fmt::format("{} of {} is missing", column.name, model.dyd), where(line.number),
                   named ? "the model needs it" : fmt::format("{} values are given", unnamed), "give it");
      values[i] = column.off;
    }
  }

  void convert(const dyd::Model& model, const Line& line, DyrRecord& out) {
    const std::vector<double> values = values_of(model, line, out.faults);
    if (!out.faults.empty()) return;
    const auto rating = base_of(line);
    const double share = share_of(model, line, rating, out);
    out.values.assign(static_cast<std::size_t>(model.columns), 0.0);
    for (const dyd::Column& column : model.fixed)
      out.values[static_cast<std::size_t>(column.dyr)] =
          column.use == dyd::Use::rating ? rating.value_or(column.off) : column.off;
    DydMachine machine;
    machine.mva = rating.value_or(0);
    for (std::size_t i = 0; i < values.size(); ++i) take(model, i, values, share, line, machine, out);
    if (model.base == "mva") {
      if (!(machine.mva > 0))
        out.faults.add(fmt::format("{} without mva=", model.dyd), where(line.number),
                       "its values are per unit of that base", "give mva=, as PSLF writes it");
      out_.machines[line.number] = machine;
    }
  }

  /// Returns the turbine's rating divided by the machine's base.
  double share_of(const dyd::Model& model, const Line& line, std::optional<double> rating, DyrRecord& out) {
    if (model.base != "mwcap" || !rating) return 1.0;
    if (std::ranges::any_of(model.fixed, [](const auto& c) { return c.use == dyd::Use::rating; })) return 1.0;
    const auto mva = mva_.find({out.bus, out.id});
    if (mva == mva_.end() || !(mva->second > 0) || !(*rating > 0)) {
      out.faults.add(fmt::format("mwcap = {:g} MW of {}", *rating, model.dyd), where(line.number),
                     "the base of its machine is not known",
                     "give the machine's record with mva= in the same file");
      return 1.0;
    }
    if (*rating != mva->second)
      out_.notes[line.number] =
          fmt::format("{} of line {} is rated {:g} MW: converted to the machine's {:g} MVA", model.dyd,
                      line.number, *rating, mva->second);
    return *rating / mva->second;
  }

  void take(const dyd::Model& model, std::size_t i, const std::vector<double>& values, double share,
            const Line& line, DydMachine& machine, DyrRecord& out) {
    const dyd::Column& column = model.in[i];
    const double v = values[i];
    const auto put = [&](double x) { out.values[static_cast<std::size_t>(column.dyr)] = x; };
    const auto idle = [&] {
      const auto at = std::ranges::find(model.in, column.idle, &dyd::Column::name);
      return !column.idle.empty() && values[static_cast<std::size_t>(at - model.in.begin())] == 0;
    };
    switch (column.use) {
      case dyd::Use::value:
        put(v);
        break;
      case dyd::Use::again:
        if (v != column.off && std::abs(v) < std::abs(out.values[static_cast<std::size_t>(column.dyr)]))
          act(model, column, v, line, out);
        break;
      case dyd::Use::mva_power:
        put(v * share);
        break;
      case dyd::Use::per_mva:
        put(v / share);
        break;
      case dyd::Use::resistance:
        machine.resistance = v;
        break;
      case dyd::Use::reactance:
        machine.reactance = v;
        break;
      case dyd::Use::off:
        if (v != column.off && !idle()) act(model, column, v, line, out);
        break;
      case dyd::Use::open:
        if (std::abs(v) < dyd::kOpen) act(model, column, v, line, out);
        break;
      case dyd::Use::free:
      case dyd::Use::rating:
        break;
    }
  }
  void act(const dyd::Model& model, const dyd::Column& column, double v, const Line& line,
           DyrRecord& out) const {
    out.faults.add(
        fmt::format("{} = {:g} of {}", column.name, v, model.dyd), where(line.number),
        fmt::format("{} has no such parameter", model.dyr),
        column.use == dyd::Use::off
            ? fmt::format("set it to {:g} if the feature is not needed, or leave the model out", column.off)
            : "widen it if the limit is not needed, or leave the model out");
  }

  std::string name_;
  std::vector<Line> lines_;
  std::map<Key, double> mva_;
  Problems problems_;
  DydSurvey out_;
};

}  // namespace

bool is_dyd(const std::filesystem::path& file) { return lower(file.extension().string()) == ".dyd"; }

DydSurvey survey_dyd(const std::filesystem::path& file) {
  return DydReader(psse::read_lines(file), file.string()).survey();
}
DydSurvey parse_dyd_survey(const std::string& text, const std::string& name) {
  return DydReader(psse::lines_of(text), name).survey();
}

std::vector<DyrRecord> chosen_records(const DydSurvey& survey, const std::string& name,
                                      const DyrOptions& options) {
  std::vector<DyrRecord> chosen;
  std::set<std::string> used;
  for (const DyrRecord& record : survey.dyr.records) {
    const std::array<std::string, 2> names{record.model, survey.names.at(record.line)};
    const auto is = [&](const std::string& asked) {
      const bool hit = std::ranges::find(names, capitals(asked)) != names.end();
      if (hit) used.insert(capitals(asked));
      return hit;
    };
    if (std::ranges::any_of(options.ignore, is)) {
      spdlog::warn("{}: {} on line {} is ignored (--ignore-model)", name, names[1], record.line);
      continue;
    }
    chosen.push_back(record);
    for (const auto& [from, to] : options.map)
      if (is(from)) {
        chosen.back().model = capitals(to);
        if (!model_of(lower(names[1]))) chosen.back().faults = {};  // the replacement is known
      }
  }
  Problems problems;
  for (const Problem& p : survey.dyr.faults) problems.add(p.what, p.where, p.why, p.remedy);
  std::vector<std::string> asked = options.ignore;
  for (const auto& [from, to] : options.map) asked.push_back(from);
  for (const std::string& model : asked)
    if (!used.contains(capitals(model)))
      problems.add("no model " + capitals(model) + " to ignore or map", name,
                   "the file has no record of that name",
                   "correct the name, or remove it from --ignore-model or --map-model (in a config: "
                   "ignore_models, map_models)");
  problems.raise();
  return chosen;
}

std::string dyd_models_text() {
  std::string text;
  for (const dyd::Model& m : dyd::models())
    text += fmt::format("{}{} -> {}", text.empty() ? "" : ", ", m.dyd, m.dyr);
  return text;
}

std::string dyd_line(const DyrRecord& record, const DydMachine& machine, const DydPlace& place,
                     const std::string& where, Problems& problems) {
  const auto all = dyd::models();
  const auto model = std::ranges::find(all, record.model, &dyd::Model::dyr);
  if (model == all.end()) {
    problems.add("model " + record.model, where,
                 "it has no PSLF counterpart; these models have one: " + dyd_models_text(),
                 "write it as .dyr, or replace the model before writing");
    return {};
  }
  const auto cell = [](std::string text, std::size_t width) {
    std::ranges::replace(text, '"', '\'');
    if (text.size() < width) text.append(width - text.size(), ' ');
    return '"' + text + '"';
  };
  std::string text = fmt::format("{:<8} {} {} {} {} : #9", model->dyd, record.bus, cell(place.bus_name, 12),
                                 psse::shortest(place.kv), cell(record.id, 2));
  double rating = machine.mva;
  for (const dyd::Column& column : model->fixed) {
    const double v = record.values.at(static_cast<std::size_t>(column.dyr));
    if (column.use == dyd::Use::rating && v > 0) rating = v;
    if (column.use != dyd::Use::rating && v != column.off)
      problems.add(fmt::format("{} = {:g} of {}", column.name, v, record.model), where,
                   "PSLF has no column for it", fmt::format("set it to {:g}", column.off));
  }
  if (!model->base.empty()) text += fmt::format(" {}={}", model->base, psse::shortest(rating));
  for (const dyd::Column& column : model->in) {
    const double v = column.use == dyd::Use::resistance  ? machine.resistance
                     : column.use == dyd::Use::reactance ? machine.reactance.value_or(0)
                     : column.dyr >= 0 ? record.values.at(static_cast<std::size_t>(column.dyr))
                                       : column.off;
    text += (model->named ? fmt::format(" \"{}\" ", column.name) : std::string(" ")) + psse::shortest(v);
  }
  return text + "\n";
}

}  // namespace swingbank::sim::formats
