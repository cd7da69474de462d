// swingbank export: a plant file as the .dyr records that are handed in.
#include <fmt/format.h>

#include "base/write_file.hpp"
#include "jobs/command_line.hpp"
#include "jobs/event_records.hpp"
#include "validate/plant/plant_dyr.hpp"

namespace {

using namespace swingbank;
using namespace swingbank::validate;

struct Arguments {
  std::string plant, id;
  std::filesystem::path out;
  int bus = 0;
};

int run(const Arguments& a) {
  plant::PlantModel model = plant::load_plant_model(a.plant);
  jobs::tell(model);
  if (model.submitted)
    throw InputError({"a model that does not hold", a.plant,
                      "it comes of a calibration that was not adequate",
                      "diagnose it, and export what 'swingbank add' makes of it"});
  if (a.bus > 0) model.bus = a.bus;
  if (!a.id.empty()) model.id = a.id;
  Problems problems;
  const std::string text = plant::dyr_text(model, {model.name}, a.plant, problems);
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

int main(int argc, char** argv) {
  jobs::CommandLine line(SWINGBANK_SUMMARY, "swingbank export");
  Arguments a;
  line.add("--dyr", a.plant,
           "plant file (configs/plants/README.md), to be written as records of a PSS/E .dyr")
      .required();
  line.add("--bus", a.bus, "bus number of the records (default: the plant file's)").positive();
  line.add("--id", a.id, "the machine's id there (default: the plant file's, else 1)");
  line.add("--out", a.out, "file to write (default: to the terminal)");
  line.footer(
      "What PSS/E keeps in the .raw (MBASE, ZR, ZX, a step-up transformer) is told in comments. Instruments "
      "and moved references belong to a record and are left out.");
  if (!line.parse(argc, argv)) return line.end();
  return jobs::guarded("export", [&] { return run(a); });
}
