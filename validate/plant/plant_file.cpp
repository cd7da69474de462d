#include "validate/plant/plant_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/input_file.hpp"
#include "base/write_file.hpp"
#include "sim/plant/parameter_id.hpp"
#include "sim/user_models/user_model.hpp"
#include "validate/plant/detail/staged.hpp"

namespace swingbank::validate::plant {
namespace {

namespace fs = std::filesystem;

/// Returns the shortest text that reads back to the same bits, with a decimal point or exponent.
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}
/// Returns the text as a TOML basic string.
std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    else
      out += c;
  }
  return out + '"';
}
/// Returns arbitrary text as comment lines.
std::string comment(const std::string& text) {
  std::string out = "# ";
  for (const char c : text) {
    if (c == '\n')
      out += "\n# ";
    else
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return out + "\n";
}

/// Returns whether the plant file did not give this parameter and its value is still the default.
bool left_default(const PlantModel& model, const sim::plant::Block& block, std::size_t i) {
  const auto& p = block.effect->parameters[i];
  return block.p[i] == p.default_value &&
         std::ranges::count(model.defaults, fmt::format("{}.{}", block.effect->name, p.name)) > 0;
}

void append_block(std::string& text, const PlantModel& model, const sim::plant::Block& block) {
  const sim::Effect& effect = *block.effect;
  const std::string slot(sim::kind_name(effect));
  text += sim::is_shared(effect.slot) ? "\n[[" + slot + "]]" : "\n[" + slot + "]";
  text += "\neffect = " + in_quotes(effect.name) + "  " + comment(std::string(effect.title));
  bool standard = false;
  for (std::size_t i = 0; i < block.p.size(); ++i) standard = standard || left_default(model, block, i);
  if (standard) text += "default_values = true  # commented parameters have default values\n";
  for (std::size_t i = 0; i < block.p.size(); ++i) {
    const auto& p = effect.parameters[i];
    const std::string entry =
        fmt::format("{}{} = {}", left_default(model, block, i) ? "# " : "", p.name, number(block.p[i]));
    text += fmt::format("{:<28} ", entry) + comment(fmt::format("[{}] {}", p.unit, p.meaning));
  }
}

/// Appends those values from before a rejected calibration that differ from the present ones.
void append_submitted(std::string& text, const PlantModel& model) {
  if (!model.submitted) return;
  text +=
      "\n[submitted]  # values from before an inadequate calibration; calibrate, add and diagnose start "
      "from them\n";
  for (int b = 0; b < sim::plant::block_count(model.plant); ++b) {
    const auto &old = sim::plant::block_at(*model.submitted, b), &now = sim::plant::block_at(model.plant, b);
    std::string changed;
    for (std::size_t i = 0; i < now.p.size(); ++i)
      if (old.p[i] != now.p[i])
        changed += fmt::format("{} = {}\n", now.effect->parameters[i].name, number(old.p[i]));
    if (!changed.empty()) text += fmt::format("[submitted.{}]\n{}", now.effect->name, changed);
  }
}

std::string compose(const PlantModel& model, const std::vector<std::string>& provenance,
                    const std::vector<std::string>& user_models) {
  std::string text;
  for (const auto& line : provenance) text += comment(line);
  std::string list;
  for (const auto& user_model : user_models) list += (list.empty() ? "" : ", ") + in_quotes(user_model);
  if (!user_models.empty()) text += "user_models = [" + list + "]\n";
  const bool power = model.conventions.mechanical_power;
  text += fmt::format(
      "[plant]\nname = {}\nbase_mva = {}  # machine base [MVA], of all per-unit values below\n"
      "frequency_hz = {}\nconventions = \"{}\"  # output of the governor: {}\nspeed_voltage = {}  # speed term in "
      "the stator voltage equations\n",
      in_quotes(model.name), number(model.plant.mva), number(model.conventions.frequency),
      power ? "psse" : "andes", power ? "power" : "torque", model.conventions.speed_voltage);
  if (model.bus > 0)
    text += fmt::format("bus = {}  # bus number in the case\nid = {}\n", model.bus, in_quotes(model.id));
  text += fmt::format("\n[record]\nbase_mva = {}  # base of P_pu and Q_pu in the records [MVA]\n",
                      number(model.record_base.mva));
  if (model.record_base.kv > 0)
    text += fmt::format("base_kv = {}  # base of voltages in kV\n", number(model.record_base.kv));
  else
    text += "# base_kv =  # nominal line-to-line voltage [kV]; required if records are in kV\n";
  if (model.record_base.efd > 0)
    text += fmt::format("efd_base = {}  # 1 pu of Efd in the records' unit\n", number(model.record_base.efd));
  if (model.record_base.ifd > 0)
    text += fmt::format("ifd_base = {}  # 1 pu of Ifd in the records' unit\n", number(model.record_base.ifd));
  if (model.dispatch)
    text += fmt::format(
        "\n[dispatch]  # operating point in the case; used to detect records of another unit or base\nP_MW = {}\n"
        "Q_Mvar = {}\nV_pu = {}\n",
        number(model.dispatch->P), number(model.dispatch->Q), number(model.dispatch->V));
  text += nameplate_text(model.nameplate, in_quotes, number);
  if (!model.reading.columns.empty()) text += "\n[record.columns]\n";
  for (const auto& [word, column] : model.reading.columns)
    text += fmt::format("{} = {}\n", word, in_quotes(column));
  text += staged_text(model.reading.staged, in_quotes, number);
  for (int b = 0; b < sim::plant::block_count(model.plant); ++b)
    append_block(text, model, sim::plant::block_at(model.plant, b));
  append_submitted(text, model);
  return text;
}

/// Returns the names of the files of user-defined models without folders. Throws InputError if two names are
/// equal.
std::vector<std::string> user_model_names(const PlantModel& model) {
  std::vector<std::string> names;
  Problems problems;
  for (const auto& user_model : model.user_models) {
    if (std::ranges::count(names, user_model.filename().string()))
      problems.add("two files of user-defined models named " + user_model.filename().string(),
                   user_model.string(), "their copies would overwrite each other", "rename one of them");
    names.push_back(user_model.filename().string());
  }
  problems.raise();
  return names;
}

/// Throws InputError if the text of the model, with absolute paths of the files of user-defined models, is
/// not read back as the same model.
void check(const PlantModel& model, const std::vector<std::string>& provenance) {
  std::vector<std::string> user_models;
  for (const auto& user_model : model.user_models) user_models.push_back(fs::absolute(user_model).string());
  const PlantModel back =
      parse_plant_model(compose(model, provenance, user_models), model.name + " as written");
  const std::string why = difference(back, model);
  if (!why.empty())
    throw InputError({"plant file of " + model.name, "writing it", "it is read back differently: " + why,
                      "this is an error of Swingbank: please report it"});
}

bool same(double a, double b) { return a == b; }  // a plant contains no NaN

std::string block_difference(const sim::plant::Block& a, const sim::plant::Block& b) {
  if (!a.effect || !b.effect ? a.effect != b.effect : !sim::user_models::same_effect(*a.effect, *b.effect))
    return fmt::format("effect {} instead of {}", a.effect ? a.effect->name : "none",
                       b.effect ? b.effect->name : "none");
  for (std::size_t i = 0; i < a.p.size(); ++i)
    if (!same(a.p[i], b.p[i]))
      return fmt::format("{}.{} = {} instead of {} {}", a.effect->name, a.effect->parameters[i].name, a.p[i],
                         b.p[i], a.effect->parameters[i].unit);
  return {};
}

}  // namespace

std::string difference(const PlantModel& a, const PlantModel& b) {
  if (a.name != b.name) return "the name";
  if (a.bus != b.bus || a.id != b.id) return "bus and id";
  if (!same(a.plant.mva, b.plant.mva)) return "the machine's base";
  if (!same(a.record_base.mva, b.record_base.mva) || !same(a.record_base.kv, b.record_base.kv))
    return "the records' base";
  if (!same(a.record_base.efd, b.record_base.efd) || !same(a.record_base.ifd, b.record_base.ifd))
    return "the base of Efd and Ifd";
  if (a.dispatch != b.dispatch) return "the dispatch";
  if (a.nameplate != b.nameplate) return "the nameplate";
  if (a.reading.columns != b.reading.columns) return "the records' columns";
  if (a.reading.staged != b.reading.staged) return "the staged events";
  if (!same(a.conventions.frequency, b.conventions.frequency) ||
      a.conventions.speed_voltage != b.conventions.speed_voltage ||
      a.conventions.mechanical_power != b.conventions.mechanical_power)
    return "the conventions";
  if (sim::plant::block_count(a.plant) != sim::plant::block_count(b.plant)) return "the number of effects";
  for (int k = 0; k < sim::plant::block_count(a.plant); ++k)
    if (auto why = block_difference(sim::plant::block_at(a.plant, k), sim::plant::block_at(b.plant, k));
        !why.empty())
      return why;
  return {};
}

std::string plant_text(const PlantModel& model, const std::vector<std::string>& provenance) {
  check(model, provenance);
  return compose(model, provenance, user_model_names(model));
}

void write_plant_file(const fs::path& file, const PlantModel& model,
                      const std::vector<std::string>& provenance) {
  const std::string text = plant_text(model, provenance);
  const auto names = user_model_names(model);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const fs::path copy = file.parent_path() / names[k];
    std::error_code none;
    if (!fs::equivalent(copy, model.user_models[k], none))
      write_file(copy,
                 read_input(model.user_models[k], "cannot read the file of a user-defined model of the plant",
                            "restore the file"));
  }
  write_file(file, text);
}

}  // namespace swingbank::validate::plant
