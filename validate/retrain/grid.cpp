// Small grid for a plant without a dataset config: the plant, three lines in series and a large machine, at
// the operating point of the records.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "base/write_file.hpp"
#include "validate/retrain/retrain.hpp"

namespace swingbank::validate::retrain {
namespace {

namespace fs = std::filesystem;

/// Reactance of each line [pu on the plant's base]; the resistance is a tenth. With these values, faults at
/// the buses reduce the plant's voltage to between zero and most of its initial value.
constexpr double kLines[] = {0.05, 0.10, 0.15};
constexpr double kLarge = 100;  ///< base of the large machine / base of the plant

void require_expressible(const plant::PlantModel& model) {
  Problems problems;
  const auto& machine = *model.plant.machine.effect;
  const std::string remedy = "give --dataset FILE, a dataset about this plant (configs/datasets)";
  if (machine.dyr_name.empty())
    problems.add("a plant with " + std::string(machine.name), model.origin, "it has no .dyr form", remedy);
  const auto& c = model.conventions;
  const auto standard = c.mechanical_power ? sim::Conventions::psse() : sim::Conventions::andes();
  if (c.speed_voltage != standard.speed_voltage)
    problems.add("a plant with conventions of its own", model.origin, "a dataset is either psse or andes",
                 remedy);
  problems.raise();
}

std::string raw_text(const plant::PlantModel& model, const event::FitEvent& event) {
  const auto& plant = model.plant;
  const double scale = event.record.base.mva / plant.mva;
  const Complex S(event.start.P * scale, event.start.Q * scale);
  const double V = std::abs(event.start.voltage);
  double x = 0;
  for (const double line : kLines) x += line;
  const Complex far = V - Complex(x / 10, x) * std::conj(S / V);
  const auto parameter = [&](int index) {
    return index < 0 ? 0.0 : plant.machine.p[static_cast<std::size_t>(index)];
  };
  double zr = parameter(plant.machine.effect->raw_resistance),
         zx = parameter(plant.machine.effect->raw_reactance);
  if (plant.machine.effect->raw_reactance < 0)
    plant.machine.effect->get<double>().machine.source_impedance(plant.machine.p.data(), zr, zx);
  std::string text =
      fmt::format("0, {}, 33, 0, 0, {}\nPlant {} behind lines\nwritten by swingbank add --retrain\n",
                  plant.mva, model.conventions.frequency, model.name);
  for (int bus = 1; bus <= 4; ++bus)
    text += fmt::format("{0}, 'BUS {0}', 110, {1}, 1, 1, 1, {2}, {3}, 1.1, 0.9, 1.1, 0.9\n", bus,
                        bus == 1   ? 2
                        : bus == 4 ? 3
                                   : 1,
                        bus == 4 ? std::abs(far) : V, bus == 4 ? std::arg(far) * 180 / constants::pi : 0.0);
  text += "0 / end of bus data\n0 / end of load data\n0 / end of fixed shunt data\n";
  const auto generator = [&](int bus, double p, double q, double v, double mva, double r, double reactance) {
    text +=
        fmt::format("{}, '1', {}, {}, 9999, -9999, {}, 0, {}, {}, {}, 0, 0, 1, 1, 100, 9999, -9999, 1, 1\n",
                    bus, p, q, v, mva, r, reactance);
  };
  generator(1, S.real() * plant.mva, S.imag() * plant.mva, V, plant.mva, zr, zx);
  generator(4, 0, 0, std::abs(far), kLarge * plant.mva, 0, 0.3);
  text += "0 / end of generator data\n";
  for (int k = 0; k < 3; ++k)
    text += fmt::format("{}, {}, '1', {}, {}, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 1, 1\n", k + 1, k + 2,
                        kLines[k] / 10, kLines[k]);
  text += "0 / end of branch data\n0 / end of transformer data\n";
  for (const char* section : {"area", "two-terminal dc line", "VSC dc line", "impedance correction",
                              "multi-terminal dc line", "multi-section line", "zone", "inter-area transfer",
                              "owner", "FACTS device", "switched shunt", "GNE device", "induction machine"})
    text += fmt::format("0 / end of {} data\n", section);
  return text + "Q\n";
}

std::string dyr_text(const plant::PlantModel& model) {
  const auto& machine = model.plant.machine;
  std::string text = fmt::format("1 '{}' '1'", machine.effect->dyr_name);
  for (const int column : machine.effect->dyr_columns)
    text += fmt::format(" {}", machine.p[static_cast<std::size_t>(column)]);
  return text + " /\n4 'GENCLS' '1' 10 0 /\n";
}

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (const auto& item : items) text += (text.empty() ? "\"" : ", \"") + item + "\"";
  return "[" + text + "]";
}

std::string config_text(const plant::PlantModel& model, double range) {
  const auto& plant = model.plant;
  std::vector<std::string> attached, user_models;
  const auto attach = [&](const sim::plant::Block& block) {
    if (block.effect == nullptr) return;
    std::string text = "1:" + std::string(block.effect->name);
    for (std::size_t i = 0; i < block.p.size(); ++i)
      text += fmt::format("{}{}={}", i == 0 ? ":" : ",", block.effect->parameters[i].name, block.p[i]);
    attached.push_back(text);
  };
  attach(plant.transformer);
  for (const auto& block : plant.controls) attach(block);
  for (const auto& user_model : model.user_models)
    user_models.push_back(fs::absolute(user_model).lexically_normal().string());
  std::string text = fmt::format("raw = \"plant.raw\"\ndyr = \"plant.dyr\"\nconvention = \"{}\"\n",
                                 model.conventions.mechanical_power ? "psse" : "andes");
  if (!user_models.empty()) text += "user_models = " + list_of(user_models) + "\n";
  if (!attached.empty()) text += "attach = " + list_of(attached) + "\n";
  text += fmt::format("\n[vary]\nwho = \"one\"\ngenerators = [1]\nmodel = \"{}\"\n\n[vary.box]\n",
                      plant.machine.effect->name);
  for (const auto& f : fit::free_parameters(plant, sim::plant::kMachineBlock, 0.2)) {
    const auto& record = sim::plant::parameter_record(plant, f.id);
    const double value = sim::plant::parameter_value(plant, f.id);
    if (value < record.low || value > record.high) continue;  // values outside the usual range stay constant
    const double one = value / range, other = value * range;
    text += fmt::format("{} = [{}, {}]\n", record.name, std::max(record.low, std::min(one, other)),
                        std::min(record.high, std::max(one, other)));
  }
  return text +
         "\n[databank]\npolicy = \"physical\"\ndistance = 0.0\n\n[fault]\nbuses = \"any\"\nstart = 2.0\n"
         "duration = [0.05, 0.2]\n";
}

}  // namespace

fs::path write_plant_grid(const fs::path& folder, const plant::PlantModel& model,
                          const event::FitEvent& event, double range) {
  require_expressible(model);
  write_file(folder / "plant.raw", raw_text(model, event));
  write_file(folder / "plant.dyr", dyr_text(model));
  write_file(folder / "base.toml", config_text(model, range));
  return folder / "base.toml";
}

}  // namespace swingbank::validate::retrain
