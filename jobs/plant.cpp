// swingbank plant: extracts one unit of a PSS/E, PSLF or MATPOWER case as a plant file. Reads only the unit's
// own records.
#include <fmt/format.h>

#include <optional>

#include "base/inputs_kept.hpp"
#include "base/write_file.hpp"
#include "jobs/command_line.hpp"
#include "sim/grid/case_words.hpp"
#include "validate/plant/plant_file.hpp"

namespace swingbank::jobs::plant_command {
namespace {

using namespace validate;

struct Arguments {
  sim::grid::UnitChoice unit;
  std::filesystem::path out, dyd;
  std::vector<std::string> replace;
  std::string conventions = "psse";
  int measured_at = 0, complete_records = 0;
};

int run(Arguments& a) {
  Problems problems;
  for (const auto& text : a.replace)
    sim::formats::add_model_map(a.unit.models, text, "--replace " + text, problems);
  if (!a.dyd.empty()) {
    a.unit.dyr = a.dyd;
    a.unit.dyd = true;
  }
  if (a.unit.dyr.empty())
    problems.add("no dynamic models", "--dyr", "a plant file needs the dynamic models of the unit",
                 "give the case's .dyr, or --dyd with its .dyd");
  problems.raise();
  a.unit.dyd = a.unit.dyd || sim::formats::is_dyd(a.unit.dyr);
  a.unit.complete_records = static_cast<sim::grid::Lacking>(a.complete_records);
  if (a.measured_at > 0) a.unit.measured_at = a.measured_at;
  const sim::grid::Unit unit = sim::grid::read_unit(a.unit);
  if (!a.out.empty()) require_inputs_kept({{a.out, "--out"}});
  const std::string files = a.unit.raw.string() + " and " + a.unit.dyr.string();
  const plant::PlantModel model = plant::model_of_unit(
      unit, a.conventions == "andes" ? sim::Conventions::andes() : sim::Conventions::psse(), files);
  std::vector<std::string> head = {fmt::format("Unit '{}' at bus {} of {} and {}", unit.id, unit.bus,
                                               a.unit.raw.filename().string(),
                                               a.unit.dyr.filename().string())};
  for (const auto* notes : {&unit.notes, &model.warnings})
    for (const auto& note : *notes) {
      fmt::print(stderr, "note: {}\n", note);
      head.push_back(note);
    }
  if (model.record_base.kv <= 0)  // printed only: in the file, the note would remain after base_kv is added
    fmt::print(stderr,
               "note: the case gives bus {} no nominal voltage (BASKV = {:g} kV): for records in kV write "
               "base_kv, line to line, under [record]\n",
               unit.bus, unit.kv);
  if (a.out.empty()) {
    fmt::print("{}", plant::plant_text(model, head));
    return 0;
  }
  plant::write_plant_file(a.out, model, head);
  fmt::print("wrote {}\n", a.out.string());
  return 0;
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  Arguments a;
  line.group("Input");
  line.add("--raw,--epc", a.unit.raw,
           "network, format by file extension: PSS/E .raw or .rawx, PSLF .epc, MATPOWER .m")
      .required();
  const auto dyr = line.add("--dyr", a.unit.dyr, "dynamic models, PSS/E .dyr");
  line.add("--dyd", a.dyd, "dynamic models, PSLF .dyd; configs/networks/README.md lists its models")
      .excludes(dyr);
  line.add("--bus", a.unit.bus, "number of the unit's bus").required().positive();
  line.add("--id", a.unit.id, "id of the unit, if the bus has several units");
  line.group("Output");
  line.add("--out", a.out, "plant file to write (default: to the terminal)");
  line.group("Models");
  line.add("--drop", a.unit.models.ignore,
           "models of the unit to leave out, comma-separated; may be repeated")
      .one_value_a_mention()
      .comma_separated();
  line.add("--replace", a.replace,
           "OLD=NEW: replace model OLD of the unit by NEW; the values are kept if both have the same "
           "number of parameters, else NEW has its default values; may be repeated")
      .one_value_a_mention();
  line.add_choice("--complete-records", a.complete_records, sim::grid::kLackingWords,
                  "records that are shorter than their model are completed with these values, longer ones "
                  "are truncated; each change is listed");
  line.group("Input");
  line.add("--measured-at", a.measured_at,
           "bus beyond the unit's transformer, where the records were taken: the transformer becomes part "
           "of the plant")
      .positive();
  line.add("--conventions", a.conventions,
           "psse: governors determine mechanical power; andes: torque; both neglect the speed term "
           "(omega = 1 pu) in the stator voltage equations")
      .one_of({"psse", "andes"})
      .shows_default();
  line.add("--frequency-hz", a.unit.frequency_hz, "nominal frequency [Hz] of a network file without one");
  line.add("--raw-version", a.unit.raw_version, "version of a .raw file without a version number, 23 to 35");
  line.footer("Only the unit's own records are read; errors in other records are ignored.");
  line.example("swingbank plant --raw grid.raw --dyr grid.dyr --bus 33 --out plant.toml");
  if (!line.parse(argc, argv)) return line.end();
  return run(a);
}

}  // namespace swingbank::jobs::plant_command
