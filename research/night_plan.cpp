// swingbank night-plan EXPERIMENT...: computes the cost of a preset from measured rates, and scales the
// preset to a number of hours.
//
// The numbers of events and of epochs each grow with the square root of the work. The number of gradient
// samples is then proportional to the work. Events and epochs have lower limits (a fold needs rows for its
// score). A budget of minutes may therefore be exceeded; the plan then says so.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/problem.hpp"
#include "jobs/command_line.hpp"
#include "research/nightly_work.hpp"

namespace swingbank::research::night_plan_command {
namespace {

using namespace swingbank::jobs;
using namespace swingbank::research;

struct Options {
  std::vector<std::string> experiments;
  std::string preset = "nightly", rates, out, name;
  double hours = 0.0;
  int cores = 1, seeds = 1;
};

struct Plan {
  std::vector<train::loop::Experiment> experiments;
  Rates rates;
  int seeds = 1;  // number of trainings with different seeds
  [[nodiscard]] std::vector<Part> parts(const train::loop::Experiment& e, const std::string& preset,
                                        const Scale& to) const {
    std::vector<Part> all = work_of(e, scaled(e.preset(preset), to), rates);
    for (auto& part : all)
      if (!part.simulated) {
        part.runs *= static_cast<std::size_t>(seeds);
        part.core_seconds *= seeds;
      }
    return all;
  }
  [[nodiscard]] double core_seconds(const std::string& preset, double work) const {
    double sum = 0.0;
    for (const auto& e : experiments)
      for (const auto& part : parts(e, preset, {preset, work})) sum += part.core_seconds;
    return sum;
  }
  /// Computes by bisection the factor of the work at which the preset takes `wanted` core-seconds; at least
  /// 1e-8.
  [[nodiscard]] double work_for(const std::string& preset, double wanted) const {
    double low = 1e-8, high = 1e6;
    for (int i = 0; i < 100; ++i) {
      const double middle = std::sqrt(low * high);
      (core_seconds(preset, middle) < wanted ? low : high) = middle;
    }
    return low;
  }
};

std::string shown(double seconds) {
  return seconds < 7200 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.1f} h", seconds / 3600);
}

/// Prints one line per part of the plan. Returns the total time [core-s].
double print(const Plan& plan, const std::string& preset, const Scale& to) {
  double sum = 0.0;
  fmt::print("| table | part | runs | rows of a run | epochs | core time |\n|---|---|---:|---:|---:|---:|\n");
  for (const auto& e : plan.experiments)
    for (const auto& part : plan.parts(e, preset, to)) {
      sum += part.core_seconds;
      fmt::print("| {} | {} | {} | {:.0f} | {} | {} |\n", e.table, part.what, part.runs, part.rows,
                 part.epochs > 0 ? std::to_string(part.epochs) : "–", shown(part.core_seconds));
    }
  return sum;
}

void run(const Options& o) {
  if (!o.out.empty() && (o.hours <= 0 || o.name.empty()))
    throw InputError({"missing --hours or --name", "--out", "the written preset needs a duration and a name",
                      "give --hours and --name"});
  if (!std::ranges::all_of(o.name, [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; }))
    throw InputError({fmt::format("invalid preset name '{}'", o.name), "--name",
                      "it becomes a key of a TOML file", "use letters, digits, - and _"});
  Plan plan;
  plan.rates = read_rates(o.rates);
  plan.seeds = o.seeds;
  for (const auto& file : o.experiments) plan.experiments.push_back(train::loop::read_experiment(file));
  Scale to{o.preset, 1.0};
  if (o.hours > 0) to.work = plan.work_for(o.preset, o.hours * 3600.0 * o.cores);
  if (!o.name.empty()) to.name = o.name;
  const double sum = print(plan, o.preset, to);
  fmt::print("\nPreset {} scaled by {:.3g}: {:.1f} core-hours, {} on {} cores.\n", o.preset, to.work,
             sum / 3600.0, shown(sum / o.cores), o.cores);
  if (o.hours > 0 && sum > 1.1 * o.hours * 3600.0 * o.cores)
    fmt::print("That exceeds the requested {}: the preset is at its smallest size.\n",
               shown(o.hours * 3600.0));
  if (o.out.empty()) return;
  for (const auto& e : plan.experiments)
    write_scaled(e, o.preset, to, std::filesystem::path(o.out) / e.file.filename());
}

}  // namespace

int run(jobs::CommandLine& line, int argc, char** argv) {
  Options o;
  line.add("experiments", o.experiments, "files of configs/experiments").required();
  line.add("--preset", o.preset, "preset of the experiments").shows_default();
  line.add("--rates", o.rates, "measured rates, research/rates.toml").required();
  line.add("--hours", o.hours, "scale the preset to this duration [h] (default: not scaled)");
  line.add("--cores", o.cores, "number of cores that share the work").shows_default().between(1, 100000);
  line.add("--seeds", o.seeds, "number of seeds for each network").shows_default().between(1, 1000);
  line.add("--name", o.name, "name of the written preset");
  line.add("--out", o.out, "folder of the experiments with the scaled preset");
  if (!line.parse(argc, argv)) return line.end();
  run(o);
  return 0;
}

}  // namespace swingbank::research::night_plan_command
