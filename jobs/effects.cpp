// swingbank effects [NAME]: what the registry holds, from the effects' own records.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include "sim/core/effect.hpp"

namespace {
using namespace swingbank::sim;

void list() {
  for (const auto& e : all_effects())
    fmt::print("{:<10} {:<10} {:>2} parameters {:>2} states  {}\n", e.name, slot_name(e.slot),
               e.parameters.size(), e.states.size(), e.title);
}

void describe(const Effect& e) {
  fmt::print("{}: {}\nslot: {}\nsource: {}\n", e.name, e.title, slot_name(e.slot), e.source);
  fmt::print("\n{:<8} {:<8} {:<5} {:>9} {:>9} {:>9} {:>8}  meaning\n", "name", "symbol", "unit", "standard",
             "low", "high", "neutral");
  for (const auto& p : e.parameters)
    fmt::print("{:<8} {:<8} {:<5} {:>9g} {:>9g} {:>9g} {:>8}  {}\n", p.name, p.symbol, p.unit, p.standard,
               p.low, p.high, std::isnan(p.neutral) ? "-" : fmt::format("{:g}", p.neutral), p.meaning);
  fmt::print("\nstates:\n");
  for (const auto& s : e.states) fmt::print("{:<8} {:<5} {}\n", s.name, s.unit, s.meaning);
  if (e.dyr_name.empty()) return;
  fmt::print("\n.dyr: {}", e.dyr_name);
  for (int column : e.dyr_columns) fmt::print(" {}", e.parameters[static_cast<std::size_t>(column)].symbol);
  fmt::print("\n");
}
}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Lists the effects the simulator knows; with a NAME, its parameters, states and source.",
               "swingbank effects"};
  std::string name;
  app.add_option("name", name, "effect, e.g. GENROU");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 1;
  }
  if (name.empty()) {
    list();
    return 0;
  }
  if (const Effect* e = find_effect(name)) {
    describe(*e);
    return 0;
  }
  const swingbank::Problem problem{"no effect '" + name + "'", "argument 1",
                                   "the registry holds " + effect_names(), "choose one of these"};
  fmt::print(stderr, "{}\n", problem.sentence());
  return 1;
}
