// swingbank export: converts a plant file to .dyr or .dyd records for submission.
#include <fmt/format.h>

#include "base/inputs_kept.hpp"
#include "base/write_file.hpp"
#include "jobs/command_line.hpp"
#include "jobs/event_records.hpp"
#include "validate/plant/plant_dyr.hpp"

namespace swingbank::jobs::export_command {
namespace {

using namespace validate;

struct Arguments {
  std::string plant, format = "dyr", id, bus_name;
  std::filesystem::path out;
  int bus = 0;
  double kv = 0;
};

int run(const Arguments& a) {
  const bool dyd = a.format == "dyd";
  const std::string& file = a.plant;
  plant::PlantModel model = plant::load_plant_model(file);
  jobs::print_warnings(model);
  if (!a.out.empty()) require_inputs_kept({{a.out, "--out"}});
  if (model.submitted)
    throw InputError({"a model that is not adequate", file,
                      "it is the result of a calibration that was not adequate",
                      "diagnose it, and export the result of 'swingbank add'"});
  if (a.bus > 0) model.bus = a.bus;
  if (!a.id.empty()) model.id = a.id;
  Problems problems;
  const double kv = a.kv > 0 ? a.kv : model.record_base.kv;
  const std::string text = dyd ? plant::dyd_text(model, {model.name}, {a.bus_name, kv}, file, problems)
                               : plant::dyr_text(model, {model.name}, file, problems);
  problems.raise();
  if (a.out.empty()) {
    fmt::print("{}", text);
  } else {
    write_file(a.out, text);
    fmt::print("wrote {}\n", a.out.string());
  }
  return 0;
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  Arguments a;
  line.group("Input");
  line.add("--model", a.plant, "plant file (configs/plants/README.md)").required();
  line.add("--bus", a.bus, "number of the unit's bus (default: the plant file's)").positive();
  line.add("--id", a.id, "id of the machine at this bus (default: the plant file's, else 1)");
  line.add("--bus-name", a.bus_name, "name of the bus, for a .dyd");
  line.add("--kv", a.kv, "nominal voltage of the bus [kV], for a .dyd (default: the plant file's base_kv)")
      .positive();
  line.group("Output");
  line.add("--format", a.format, "dyr: records of PSS/E; dyd: lines of PSLF")
      .one_of({"dyr", "dyd"})
      .shows_default();
  line.add("--out", a.out, "file to write (default: to the terminal)");
  line.example("swingbank export --model added/model.toml --format dyr --bus 33 --out unit.dyr");
  line.footer(
      "Data that PSS/E keeps in the .raw (MBASE, ZR, ZX, a step-up transformer) are written as "
      "comments. Instruments and changed references belong to a record and are omitted.");
  if (!line.parse(argc, argv)) return line.end();
  return run(a);
}

}  // namespace swingbank::jobs::export_command
