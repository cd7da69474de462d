// Files of a blind case: the folder with model and records, and the truth.
#include <fmt/format.h>

#include "base/write_file.hpp"
#include "research/blind/cases/case.hpp"
#include "research/blind/cases/detail/world.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::research::blind::cases {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json block_json(const sim::plant::Block& block) {
  json parameters;
  for (std::size_t k = 0; k < block.p.size(); ++k)
    parameters[std::string(block.effect->parameters[k].name)] = block.p[k];
  return {{"effect", block.effect->name},
          {"slot", sim::slot_name(block.effect->slot)},
          {"parameters", parameters}};
}

json plant_json(const sim::plant::Plant& plant) {
  json all = {{"machine", block_json(plant.machine)}, {"controls", json::array()}};
  if (plant.transformer.effect) all["controls"].push_back(block_json(plant.transformer));
  for (const auto* list : {&plant.controls, &plant.measurements})
    for (const auto& block : *list) all["controls"].push_back(block_json(block));
  return all;
}

json truth_json(const BlindCase& made, const BlindConfig& config, const std::string& name) {
  json hidden = json::array(), events = json::array();
  for (const auto& h : made.hidden)
    hidden.push_back({{"kind", h.kind->name},
                      {"listed", h.kind->listed},
                      {"side", h.kind->side},
                      {"value", h.kind->value},
                      {"answers", h.kind->accepted_names},
                      {"scale", h.scale},
                      {"limit_noise", h.kind->limit},
                      {"wanted_noise", h.wanted},
                      {"left_noise", h.left},
                      {"visible_noise", h.visible}});
  for (const auto& e : made.events) events.push_back({{"what", e.text}, {"switchings_s", e.switchings}});
  return {{"format", "swingbank-blind-1"},
          {"case", name},
          {"seed", made.spec.seed},
          {"index", made.spec.index},
          {"config_hash", fmt::format("{:016x}", config.hash)},
          {"maker", made.maker},
          {"attempts", made.attempts},
          {"grid", made.grid_name},
          {"plant", made.plant_name},
          {"machine_mva", made.truth.mva},
          {"hidden", hidden},
          {"events", events},
          {"noise_of_mva", made.noise},
          {"voltage_noise_pu", made.voltage_noise},
          {"pmu_filter", made.pmu_filter},
          {"conditions", made.conditions},
          {"channels", made.channels ? "P,Q,speed,Ifd" : "P,Q"},
          {"other_plants_controlled", made.controlled},
          {"speed_voltage", made.conventions.speed_voltage},
          {"mechanical_power", made.conventions.mechanical_power},
          {"true_plant", plant_json(made.truth)},
          {"model", plant_json(made.model)},
          {"other_unit", made.other ? plant_json(*made.other) : json()}};
}

std::string model_file(const sim::plant::Plant& plant, const std::string& name,
                       const sim::Conventions& conventions, const char* what) {
  validate::plant::PlantModel model;
  model.name = name;
  model.plant = plant;
  model.plant.name = name;
  model.conventions = conventions;
  model.record_base.mva = kRecordMva;
  model.record_base.frequency = conventions.frequency;
  return validate::plant::plant_text(model, {what});
}

/// Returns the file of both units at the measuring point, as `--point` reads it (configs/plants/README.md).
std::string point_file(const BlindCase& made) {
  const double share = made.other->mva / (made.other->mva + made.model.mva);
  return fmt::format(
      "[[unit]]\nmodel = \"model.toml\"\n\n[[unit]]\nmodel = \"other.toml\"\nshare = {:.12g}\n", share);
}

}  // namespace

void write_blind_case(const BlindCase& made, const BlindConfig& config, const std::string& name,
                      const fs::path& folder, const fs::path& truth) {
  write_file(truth, truth_json(made, config, name).dump(1) + "\n");
  const fs::path partial = folder.parent_path() / ("." + folder.filename().string() + ".partial");
  fs::remove_all(partial);
  write_file(partial / "model.toml",
             model_file(made.model, name, sim::Conventions::psse(made.conventions.frequency),
                        "Plant of a blind case, as submitted by its owner"));
  if (made.other) {
    write_file(partial / "other.toml",
               model_file(*made.other, name + "/2", made.conventions, "The unit recorded with it, as it is"));
    write_file(partial / "point.toml", point_file(made));
  }
  for (std::size_t e = 0; e < made.records.size(); ++e)
    write_file(partial / fmt::format("event{}.csv", e + 1), record_csv(made.records[e]));
  fs::rename(partial, folder);
}

}  // namespace swingbank::research::blind::cases
