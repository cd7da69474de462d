// swingbank effects [NAME...]: lists the effects of the library with equations, parameters and sources.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/capitals.hpp"
#include "base/json.hpp"
#include "base/nearest_word.hpp"
#include "jobs/command_line.hpp"
#include "jobs/effect_coverage.hpp"
#include "sim/library/library.hpp"
#include "sim/user_models/user_model.hpp"

namespace swingbank::jobs::effects_command {
namespace {
using namespace sim;
using Json = nlohmann::ordered_json;

std::string_view slot_meaning(Slot slot) {
  constexpr std::array<std::string_view, kSlots.size()> meanings = {
      "the source: a synchronous machine or a converter",
      "between the machine's terminal and the grid",
      "Vc, the compensated voltage that the exciter regulates",
      "references of exciter and governor",
      "mechanical torque",
      "torque after the governor",
      "Vs, the stabiliser's signal",
      "signal added to the voltage error",
      "field voltage",
      "references of a converter's P and Q",
      "reference of a wind turbine's power from its speed",
      "pitch angle of a wind turbine",
      "wind power at the shaft",
      "shaft of turbine and generator",
      "current commands of a converter",
      "load at a bus",
      "instrument between the grid and the record"};
  return meanings[static_cast<std::size_t>(slot)];
}

void print_list(const library::EffectLibrary& library) {
  for (const Slot slot : kSlots) {
    bool any = false;
    for (const Effect* e : library.all()) {
      if (e->slot != slot) continue;
      if (!std::exchange(any, true)) fmt::print("{}: {}\n", slot_name(slot), slot_meaning(slot));
      fmt::print("  {:<11} {}{}\n", e->name, e->title, e->user_model ? " (user-defined model)" : "");
    }
  }
}

std::string number(double value) { return std::isnan(value) ? "-" : fmt::format("{:g}", value); }

/// Prints rows in columns of equal width, except for the last column.
void print_table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> width(rows[0].size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  for (const auto& row : rows) {
    std::string line = "  ";
    for (std::size_t c = 0; c + 1 < row.size(); ++c) line += fmt::format("{:<{}}  ", row[c], width[c]);
    fmt::print("{}{}\n", line, row.back());
  }
}

/// Footnotes: sources of an effect's values, numbered in order of first use.
class Footnotes {
 public:
  /// Returns the source numbers of a parameter: "1", or "1 2" if default and bounds have different sources.
  std::string marks(const Parameter& p) {
    const auto value = number_of(p.default_from), bounds = number_of(p.bounds_from);
    return value == bounds ? fmt::format("{}", value) : fmt::format("{} {}", value, bounds);
  }
  void print() const {
    fmt::print("\nsources (if two: of the default value, of the bounds)\n");
    for (std::size_t i = 0; i < texts_.size(); ++i) fmt::print("  {:>2}  {}\n", i + 1, texts_[i]);
    for (const Work* work : works_)
      fmt::print("  {}: {}, {} ({}), {}\n", work->id, work->author, work->title, work->edition, work->where);
  }

 private:
  std::size_t number_of(const Source& source) {
    const std::string text = as_text(source);
    auto at = std::ranges::find(texts_, text);
    if (at == texts_.end()) {
      at = texts_.insert(at, text);
      if (source.work->published() && std::ranges::find(works_, source.work) == works_.end())
        works_.push_back(source.work);
    }
    return static_cast<std::size_t>(at - texts_.begin()) + 1;
  }
  std::vector<std::string> texts_;
  std::vector<const Work*> works_;
};

void describe(const Effect& e) {
  fmt::print("{}: {}\nslot: {} ({})\nsource: {}\n", e.name, e.title, kind_name(e), slot_meaning(e.slot),
             e.source);
  if (e.description.find_first_not_of(" \n") != std::string_view::npos) {
    const auto begin = e.description.find_first_not_of('\n');
    fmt::print("\n{}", e.description.substr(begin));
    if (!e.description.ends_with('\n')) fmt::print("\n");
  }
  if (!e.parameters.empty()) {
    std::vector<std::vector<std::string>> rows = {
        {"name", "symbol", "unit", "default", "lowest", "highest", "null", "sources", "meaning"}};
    Footnotes sources;
    for (const Parameter& p : e.parameters)
      rows.push_back({std::string(p.name), std::string(p.symbol), std::string(p.unit),
                      number(p.default_value), number(p.low), number(p.high), number(p.null_value),
                      sources.marks(p), std::string(p.meaning)});
    fmt::print("\nparameters (null: value without influence; unit code: number of a choice)\n");
    print_table(rows);
    sources.print();
  }
  if (!e.states.empty()) {
    std::vector<std::vector<std::string>> rows = {{"name", "unit", "meaning"}};
    for (const State& s : e.states)
      rows.push_back({std::string(s.name), std::string(s.unit), std::string(s.meaning)});
    fmt::print("\nstates\n");
    print_table(rows);
  }
  if (e.dyr_name.empty()) return;
  fmt::print("\n.dyr: BUS '{}' ID", e.dyr_name);
  for (int column : e.dyr_columns) fmt::print(" {}", e.parameters[static_cast<std::size_t>(column)].symbol);
  fmt::print(" /\n");
}

Json value(double v) { return std::isnan(v) ? Json(nullptr) : Json(v); }

Json as_json(const Effect& e) {
  Json j = {{"name", e.name},
            {"title", e.title},
            {"slot", slot_name(e.slot)},
            {"source", e.source},
            {"description", e.description},
            {"user_model", e.user_model != nullptr},
            {"parameters", Json::array()},
            {"states", Json::array()}};
  for (const Parameter& p : e.parameters)
    j["parameters"].push_back({{"name", p.name},
                               {"symbol", p.symbol},
                               {"unit", p.unit},
                               {"default", value(p.default_value)},
                               {"low", value(p.low)},
                               {"high", value(p.high)},
                               {"null_value", value(p.null_value)},
                               {"default_from", as_text(p.default_from)},
                               {"bounds_from", as_text(p.bounds_from)},
                               {"limit", p.limit > 0   ? "upper"
                                         : p.limit < 0 ? "lower"
                                                       : ""},
                               {"meaning", p.meaning}});
  for (const State& s : e.states)
    j["states"].push_back({{"name", s.name}, {"unit", s.unit}, {"meaning", s.meaning}});
  if (e.dyr_name.empty()) return j;
  j["dyr"] = {{"name", e.dyr_name}, {"columns", Json::array()}};
  for (int column : e.dyr_columns)
    j["dyr"]["columns"].push_back(e.parameters[static_cast<std::size_t>(column)].name);
  return j;
}

/// Returns the five names nearest to `name`, nearest first.
std::string nearest_names(const library::EffectLibrary& library, const std::string& name) {
  std::vector<std::pair<std::size_t, std::string_view>> list;
  for (const Effect* e : library.all())
    list.emplace_back(edit_distance(capitals(name), capitals(e->name)), e->name);
  std::ranges::stable_sort(list, {}, [](const auto& one) { return one.first; });
  list.resize(std::min<std::size_t>(list.size(), 5));
  std::string names;
  for (const auto& one : list) names += (names.empty() ? "" : ", ") + std::string(one.second);
  return names;
}

/// Returns whether a name begins like that of an inverter, wind or storage model.
bool is_inverter(const std::string& name) {
  constexpr std::string_view kBeginnings[] = {"REGC", "REEC", "REPC", "WT1",  "WT2", "WT3",  "WT4",
                                              "WTDT", "WTAR", "WTPT", "WTTQ", "PVG", "PVEU", "DERA"};
  return std::ranges::any_of(kBeginnings, [&](std::string_view b) { return name.starts_with(b); });
}

/// Prints the effect's table in a plant file, with default values.
void print_toml(const Effect& e) {
  const std::string slot(kind_name(e));
  fmt::print("{}\n", is_shared(e.slot) ? "[[" + slot + "]]" : "[" + slot + "]");
  fmt::print("effect = \"{}\"  # {}\n", e.name, e.title);
  for (const Parameter& p : e.parameters) {
    std::string value = fmt::format("{}", p.default_value);
    if (value.find_first_of(".e") == std::string::npos) value += ".0";
    fmt::print("{:<28} # [{}] {}, from {:g} to {:g}\n", fmt::format("{} = {}", p.name, value), p.unit,
               p.meaning, p.low, p.high);
  }
}

struct Shape {
  bool json = false, toml = false;
};

int run(const std::vector<std::string>& names, const std::vector<std::string>& user_models,
        const Shape& shape) {
  library::EffectLibrary library;
  for (const auto& file : user_models) user_models::load_user_model(file, library);
  Problems problems;
  std::vector<const Effect*> chosen;
  for (const auto& name : names) {
    chosen.push_back(library.find(name));
    const std::string typed = capitals(name);
    const bool begun =
        std::ranges::any_of(library.all(), [&](const Effect* e) { return e->name.starts_with(typed); });
    if (!chosen.back() && is_inverter(typed) && !begun)
      problems.add("unknown effect '" + name + "'", "NAME",
                   "this model of inverters, wind or storage is not supported yet",
                   "list the supported ones with swingbank effects");
    else if (!chosen.back())
      problems.add("unknown effect '" + name + "'", "NAME",
                   "the nearest names are " + nearest_names(library, name),
                   "choose one of these, or see them all with swingbank effects");
  }
  if (shape.toml && names.empty())
    problems.add("--toml without an effect", "NAME", "--toml prints the block of one effect",
                 "name it; swingbank effects lists them all");
  problems.raise();
  const auto& shown = names.empty() ? library.all() : chosen;
  if (shape.json) {
    Json all = Json::array();
    for (const Effect* e : shown) all.push_back(as_json(*e));
    fmt::print("{}\n", all.dump(1));
  } else if (names.empty()) {
    print_list(library);
  } else {
    for (const Effect* e : shown) {
      if (e != shown.front()) fmt::print("\n");
      shape.toml ? print_toml(*e) : describe(*e);
    }
  }
  return 0;
}
}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  line.describe(
      "Lists the effects of the simulator by slot; with a NAME, its block diagram, equations, "
      "parameters, states and source.");
  std::vector<std::string> names, user_models, dyr_files;
  Shape shape;
  const jobs::Option effects = line.add("NAME", names, "effects, e.g. GENROU SEXS");
  const jobs::Option user_model =
      line.add("--user-model", user_models, "file (.toml) of a user-defined model; may be repeated")
          .one_value_a_mention();
  line.add("--coverage", dyr_files,
           "PSS/E .dyr files: print for each model how many of its records Swingbank supports")
      .excludes(effects)
      .excludes(user_model);
  const jobs::Option json =
      line.add_flag("--json", shape.json,
                    "print as JSON: an array with one object per effect, or with --coverage one object");
  line.add_flag("--toml", shape.toml, "print the effect's table of a plant file, with default values")
      .excludes(json);
  line.example("swingbank effects SEXS --toml");
  if (!line.parse(argc, argv)) return line.end();
  return dyr_files.empty() ? run(names, user_models, shape) : jobs::print_coverage(dyr_files, shape.json);
}

}  // namespace swingbank::jobs::effects_command
