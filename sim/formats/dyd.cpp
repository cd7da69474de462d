#include "sim/formats/dyd.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "base/capitals.hpp"
#include "sim/formats/detail/dyd_models.hpp"
#include "sim/formats/psse_text.hpp"

namespace swingbank::sim::formats {
namespace {

std::string lower(std::string_view text) {
  std::string all(text);
  std::ranges::transform(all, all.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return all;
}

struct Token {
  std::string text;
  bool quoted = false;
};

/// A record with its continuation lines; no tokens behind the colon where it has none.
struct Line {
  int number = 0;
  bool colon = false;
  std::vector<Token> head, tail;
};

/// Words, texts in quotes, ':' by itself.
std::vector<Token> tokens_of(const std::string& text, const std::string& where, Problems& problems) {
  std::vector<Token> tokens;
  for (std::size_t i = 0; i < text.size();) {
    if (std::isspace(static_cast<unsigned char>(text[i])) != 0) {
      ++i;
    } else if (text[i] == '"') {
      const auto end = text.find('"', i + 1);
      if (end == std::string::npos)
        problems.add("a text without an end", where, "a quote opens and none closes", "close it");
      tokens.push_back({text.substr(i + 1, end == std::string::npos ? end : end - i - 1), true});
      i = end == std::string::npos ? text.size() : end + 1;
    } else {
      std::size_t end = i + 1;
      while (text[i] != ':' && end < text.size() && text[end] != '"' && text[end] != ':' &&
             std::isspace(static_cast<unsigned char>(text[end])) == 0)
        ++end;
      tokens.push_back({text.substr(i, end - i), false});
      i = end;
    }
  }
  return tokens;
}

std::string trimmed(std::string text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

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
    Line open;
    bool goes_on = false;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      std::string text = trimmed(lines[i]);
      while (!text.empty() && text.back() == '\r') text.pop_back();
      if (text.empty() || text[0] == '#') continue;
      if (!goes_on) open = {static_cast<int>(i) + 1, false, {}, {}};
      goes_on = text.back() == '/';
      if (goes_on) text.pop_back();
      for (Token& token : tokens_of(text, where(static_cast<int>(i) + 1), problems_))
        if (!open.colon && !token.quoted && token.text == ":")
          open.colon = true;
        else
          (open.colon ? open.tail : open.head).push_back(std::move(token));
      if (!goes_on) lines_.push_back(open);
    }
    if (goes_on) lines_.push_back(open);
  }

  /// Bus and id of a record of a unit: model, bus, name, kV, id.
  [[nodiscard]] static std::optional<Key> key_of(const Line& line) {
    if (!line.colon || line.head.size() < 5) return std::nullopt;
    const auto bus = psse::parse_number(line.head[1].text);
    if (!bus || *bus != std::floor(*bus) || std::abs(*bus) > 1e9L) return std::nullopt;
    const std::string id = trimmed(line.head[4].text);
    return Key{static_cast<int>(*bus), id.empty() ? "1" : id};
  }
  /// The value of "mva=" or "mwcap=".
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
    if (dyd::is_no_unit(name)) return;
    const auto key = key_of(line);
    if (!key) {  // a word that divides the file, or a record between two buses
      if (model)
        problems_.add("a record that cannot be told", where(line.number),
                      "it is: model bus \"name\" kV \"id\" : values",
                      "give the bus by its number, and a ':' before the values");
      return;
    }
    DyrRecord out{key->first, capitals(name), key->second, {}, line.number};
    if (!model) {
      for (const Token& token : line.tail)
        if (const auto v = psse::parse_number(token.text); v && !token.quoted)
          out.values.push_back(static_cast<double>(*v));
      out_.dyr.records.push_back(std::move(out));
      return;
    }
    out.model = model->dyr;
    convert(*model, line, out);
    out_.dyr.records.push_back(std::move(out));
  }

  /// The values of the columns in the model's order; NaN where one is not given.
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
          faults.add(fmt::format("{} of {}", column, model.dyd), where(line.number),
                     "no column of that name is known", "remove it, or leave the model out with --drop");
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
                   "this is no number", "correct the record");
      else if (at < values.size())
        values[at] = static_cast<double>(*v);
    }
    check_count(model, line, values, named, next, faults);
    return values;
  }
  void check_count(const dyd::Model& model, const Line& line, std::vector<double>& values, bool named,
                   std::size_t unnamed, Problems& faults) const {
    if (unnamed > 0 && !model.in_order) {
      faults.add(fmt::format("{} with values without names", model.dyd), where(line.number),
                 "the order of its values is not documented in public", "write each value behind its name");
      return;
    }
    if (unnamed > values.size())
      faults.add(fmt::format("{} with {} values", model.dyd, unnamed), where(line.number),
                 fmt::format("{} are known", values.size()), "remove what is too much");
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isnan(values[i])) continue;
      const dyd::Column& column = model.in[i];
      const bool may_lack = column.use == dyd::Use::off || column.use == dyd::Use::open ||
                            column.use == dyd::Use::free || column.use == dyd::Use::again;
      if (!may_lack)
        faults.add(fmt::format("no {} of {}", column.name, model.dyd), where(line.number),
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

  /// The turbine's rating over the machine's base.
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
      out_.notes[line.number] = fmt::format("{} of line {} is rated {:g} MW: put onto the machine's {:g} MVA",
                                            model.dyd, line.number, *rating, mva->second);
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
    out.faults.add(fmt::format("{} = {:g} of {}", column.name, v, model.dyd), where(line.number),
                   fmt::format("{} has nothing of the kind", model.dyr),
                   column.use == dyd::Use::off
                       ? fmt::format("set it to {:g} if that is meant, or leave the model out", column.off)
                       : "set it wide if that is meant, or leave the model out");
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
                 "no PSLF model is known for it; known are " + dyd_models_text(),
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
