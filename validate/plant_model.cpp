#include "validate/plant_model.hpp"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace swingbank::validate {
namespace {

namespace fs = std::filesystem;

/// Reads typed values from a TOML table and collects what is wrong with them, each with its line.
class Section {
 public:
  Section(const toml::table& table, std::string name, std::string file, Problems& problems)
      : table_(table), name_(std::move(name)), file_(std::move(file)), problems_(problems) {}

  [[nodiscard]] std::string where(const toml::node* node = nullptr) const {
    const auto line = (node ? node : static_cast<const toml::node*>(&table_))->source().begin.line;
    return line > 0 ? fmt::format("{}:{}", file_, line) : file_;
  }
  [[nodiscard]] std::string key_name(std::string_view key) const { return name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key); }

  void allow_only(const std::vector<std::string>& keys) {
    for (const auto& [key, node] : table_)
      if (std::ranges::find(keys, key.str()) == keys.end()) {
        std::string list;
        for (const auto& k : keys) list += (list.empty() ? "" : ", ") + k;
        problems_.add(fmt::format("key '{}'", key_name(key.str())), where(&node), "it is not known here", "use " + list);
      }
  }
  std::optional<double> number(std::string_view key, bool required = true) {
    const auto* node = get(key, required, "a number");
    if (!node) return std::nullopt;
    if (const auto v = node->value<double>(); v && node->is_number() && std::isfinite(*v)) return v;
    problems_.add(fmt::format("'{}'", key_name(key)), where(node), "it is not a finite number", "give a number without quotes");
    return std::nullopt;
  }
  std::optional<double> positive(std::string_view key, bool required = true) {
    const auto v = number(key, required);
    if (v && !(*v > 0)) {
      problems_.add(fmt::format("{} = {:g}", key_name(key), *v), where(table_.get(key)), "it must be above zero", "give a positive number");
      return std::nullopt;
    }
    return v;
  }
  std::optional<std::string> text(std::string_view key, bool required = true) {
    const auto* node = get(key, required, "text");
    if (!node) return std::nullopt;
    if (node->is_string()) return *node->value<std::string>();
    problems_.add(fmt::format("'{}'", key_name(key)), where(node), "it is not text", "put it in quotes");
    return std::nullopt;
  }
  [[nodiscard]] const toml::table& table() const { return table_; }

 private:
  const toml::node* get(std::string_view key, bool required, std::string_view kind) {
    const auto* node = table_.get(key);
    if (!node && required) problems_.add(fmt::format("no '{}'", key_name(key)), where(), "it is never assumed", fmt::format("add {} = <{}>", key, kind));
    return node;
  }
  const toml::table& table_;
  std::string name_, file_;
  Problems& problems_;
};

class Loader {
 public:
  explicit Loader(const fs::path& file) : file_(file) {}

  PlantModel load() {
    std::ifstream in(file_, std::ios::binary);
    std::ostringstream text;
    if (!in || !(text << in.rdbuf())) throw InputError({"no readable plant file", file_.string(), "it cannot be opened or is empty", "give the path of a plant .toml"});
    const std::string content = text.str();
    model_.origin = file_.string();
    model_.hash = XXH64(content.data(), content.size(), 0);
    try {
      root_ = toml::parse(content, file_.string());
    } catch (const toml::parse_error& error) {
      throw InputError({"no valid TOML", fmt::format("{}:{}", file_.string(), error.source().begin.line), std::string(error.description()), "mend the line"});
    }
    Section top(root_, "", file_.string(), problems_);
    top.allow_only({"plant", "record", "machine", "control", "grid"});
    plant(top);
    record(top);
    problems_.raise();
    return std::move(model_);
  }

 private:
  std::optional<Section> section(Section& top, const std::string& key, bool required) {
    const auto* node = root_.get(key);
    if (node && node->is_table()) return Section(*node->as_table(), key, file_.string(), problems_);
    if (node || required)
      problems_.add(node ? fmt::format("'{}'", key) : fmt::format("no section [{}]", key), node ? top.where(node) : file_.string(),
                    node ? "it is not a section" : "the plant is not complete without it", fmt::format("write [{}] and its keys below it", key));
    return std::nullopt;
  }

  void plant(Section& top) {
    auto s = section(top, "plant", true);
    if (!s) return;
    s->allow_only({"name", "base_mva", "frequency_hz", "conventions", "origin"});
    model_.name = s->text("name").value_or("");
    s->text("origin", false);
    const double hz = s->positive("frequency_hz").value_or(60.0);
    conventions(*s, hz);
    model_.record_base.frequency = hz;
    if (root_.contains("grid")) {
      if (root_.contains("machine") || root_.contains("control") || s->table().contains("base_mva"))
        problems_.add("both [grid] and a machine of its own", file_.string(), "the plant would be given twice", "keep [grid], or [machine], [[control]] and plant.base_mva");
      else
        from_grid(top);
      return;
    }
    model_.plant.name = model_.name;
    model_.plant.mva = s->positive("base_mva").value_or(100.0);
    if (auto machine = section(top, "machine", true))
      if (auto block = effect(*machine, true)) model_.plant.machine = std::move(*block);
    controls(top);
  }

  void conventions(Section& s, double hz) {
    const auto name = s.text("conventions");
    if (!name) return;
    if (*name == "psse") model_.conventions = sim::Conventions::psse(hz);
    else if (*name == "andes") model_.conventions = sim::Conventions::andes(hz);
    else problems_.add(fmt::format("plant.conventions = '{}'", *name), s.where(s.table().get("conventions")), "there is no such set", "use psse (speed voltage, power) or andes (neither)");
  }

  void record(Section& top) {
    auto s = section(top, "record", true);
    if (!s) return;
    s->allow_only({"base_mva", "base_kv"});
    model_.record_base.mva = s->positive("base_mva").value_or(100.0);
    model_.record_base.kv = s->positive("base_kv", false).value_or(0.0);
  }

  void controls(Section& top) {
    const auto* node = root_.get("control");
    if (!node) return;
    const auto* list = node->as_array();
    if (!list || !list->is_array_of_tables()) {
      problems_.add("'control'", top.where(node), "it is not a list of sections", "write [[control]] once per control");
      return;
    }
    std::vector<sim::Slot> taken;
    for (const auto& item : *list) {
      Section s(*item.as_table(), "control", file_.string(), problems_);
      auto block = effect(s, false);
      if (!block) continue;
      const auto slot = block->effect->slot;
      if (std::ranges::find(taken, slot) != taken.end())
        problems_.add(fmt::format("a second {}", sim::slot_name(slot)), s.where(), "a plant has one of each", "leave one of them");
      taken.push_back(slot);
      model_.plant.controls.push_back(std::move(*block));
    }
    std::ranges::stable_sort(model_.plant.controls, {}, [](const sim::Block& b) { return b.effect->slot; });
  }

  /// One effect by name with every parameter by name.
  std::optional<sim::Block> effect(Section& s, bool machine) {
    const auto name = s.text("effect");
    if (!name) return std::nullopt;
    const auto* found = sim::find_effect(*name);
    if (!found || (found->slot == sim::Slot::machine) != machine) {
      problems_.add(fmt::format("effect '{}'", *name), s.where(s.table().get("effect")), found ? "it does not belong in this slot" : "it is not known",
                    "use one of " + sim::effect_names());
      return std::nullopt;
    }
    std::vector<std::string> keys = {"effect"};
    for (const auto& p : found->parameters) keys.emplace_back(p.name);
    s.allow_only(keys);
    sim::Block block{found, {}};
    for (const auto& p : found->parameters) block.p.push_back(parameter(s, p));
    const bool complete = std::ranges::none_of(block.p, [](double v) { return std::isnan(v); });
    if (complete) found->check(block.p.data(), s.where(), problems_);
    return complete ? std::optional(block) : std::nullopt;
  }

  double parameter(Section& s, const sim::Parameter& p) {
    const auto v = s.number(p.name);
    if (!v) return std::nan("");
    if (*v < p.low || *v > p.high)
      problems_.add(fmt::format("{} = {:g} {}", p.name, *v, p.unit), s.where(s.table().get(p.name)),
                    fmt::format("{} can lie between {:g} and {:g} {}", p.meaning, p.low, p.high, p.unit), "check the value and its unit and base");
    return *v;
  }

  void from_grid(Section& top) {
    auto s = section(top, "grid", true);
    if (!s) return;
    s->allow_only({"raw", "dyr", "bus", "id"});
    const auto raw = s->text("raw"), dyr = s->text("dyr"), id = s->text("id", false);
    const auto bus = s->positive("bus");
    if (!raw || !dyr || !bus) return;
    const fs::path folder = file_.parent_path();
    const sim::Grid grid = sim::load_grid(folder / *raw, folder / *dyr, model_.conventions);
    const std::string plain = fmt::format("{:g}", *bus), wanted = id ? plain + "/" + *id : plain;
    const auto plant = std::ranges::find_if(grid.plants, [&](const sim::Plant& p) { return p.name == wanted || (!id && p.name == plain) || (id && p.name == plain); });
    if (plant == grid.plants.end()) {
      std::string all;
      for (const auto& p : grid.plants) all += (all.empty() ? "" : ", ") + p.name;
      problems_.add(fmt::format("no plant {}", wanted), s->where(), "the grid has no such generator with a model", "use one of " + all);
      return;
    }
    model_.plant = *plant;
  }

  fs::path file_;
  toml::table root_;
  PlantModel model_;
  Problems problems_;
};

}  // namespace

PlantModel load_plant_model(const fs::path& file) { return Loader(file).load(); }

}  // namespace swingbank::validate
