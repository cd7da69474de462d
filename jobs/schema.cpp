// swingbank schema: JSON Schema of the files that a user writes, for editors and for checks.
#include <fmt/format.h>

#include "base/child.hpp"
#include "base/own_command.hpp"
#include "base/write_file.hpp"
#include "jobs/command_line.hpp"
#include "mpi/draw/dataset_config.hpp"
#include "validate/benchmark/test_set.hpp"
#include "validate/event/point.hpp"
#include "validate/fleet/fleet_file.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"
#include "validate/system/system.hpp"
#include "validate/thresholds/acceptance.hpp"

namespace swingbank::jobs::schema_command {
namespace {

/// Returns the schema of experiments. A separate program, which links LibTorch, prints it.
std::string experiment_schema() {
  const std::string program = jobs::own_command("schema-experiment", "install swingbank-train").string();
  const ProgramEnd end = run_program(program, {program}, {.output = ProgramRun::Output::taken});
  if (end.code() != 0)
    throw InputError({fmt::format("exit code {}", end.code()), program,
                      "it did not print the schema of experiments", "install swingbank-train again"});
  return end.output;
}

struct Kind {
  const char *name, *content;
  std::string (*schema)();
};
constexpr Kind kKinds[] = {
    {"plant", "plant file: model of one plant (--model)", validate::plant::plant_schema},
    {"records", "columns of a record: one row as an object (--records)", validate::record::record_schema},
    {"point", "units behind one measured point (--point)", validate::event::point_schema},
    {"accept", "limits of fitness for purpose (--accept)", validate::thresholds::acceptance_schema},
    {"fleet", "many plants with their records (diagnose --fleet)", validate::fleet::fleet_schema},
    {"system", "grid, event and records of several terminals (compare --system)",
     validate::system::system_schema},
    {"benchmark", "tests of a model against EMT records or another model (benchmark --tests)",
     validate::benchmark::tests_schema},
    {"dataset", "distribution of a dataset (databank, generate)", mpi::draw::dataset_schema},
    {"experiment", "training of networks (train, cross-validate)", experiment_schema},
};

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

int run(const std::string& wanted, const std::filesystem::path& out) {
  if (wanted.empty() && out.empty()) {
    for (const Kind& kind : kKinds) fmt::print("{:<11} {}\n", kind.name, kind.content);
    return 0;
  }
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  for (const Kind& kind : kKinds) {
    if (!wanted.empty() && wanted != kind.name) continue;
    try {
      files.emplace_back(out / (std::string(kind.name) + ".json"), kind.schema());
    } catch (const InputError& error) {
      if (!wanted.empty()) throw;
      fmt::print(stderr, "{}\n", error.what());  // training programs missing: the other kinds are written
    }
  }
  for (const auto& [file, text] : files)
    if (out.empty())
      fmt::print("{}", text);
    else
      write_file(file, text);
  return 0;
}
}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  line.describe(
      "Prints the JSON Schema of a kind of file, for completion and checks in an editor; without a KIND, the list of "
      "kinds.");
  std::string kind;
  std::filesystem::path out;
  line.add("KIND", kind, "kind of file").one_of(kind_names());
  line.add("--out", out, "write KIND.json into this folder; without a KIND, one file for each kind");
  line.example("swingbank schema plant > plant.json");
  if (!line.parse(argc, argv)) return line.end();
  try {
    return run(kind, out);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

}  // namespace swingbank::jobs::schema_command
