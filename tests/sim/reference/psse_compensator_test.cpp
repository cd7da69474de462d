// CSVGN1 against PSS/E's own record (psse_folder.hpp): 55 MW less at the neighbouring bus.
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "tests/sim/reference/psse_folder.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::reference {
namespace {

/// The record's case has no unit at bus 3. The program that published the record adds the compensator in its
/// test 49, with 500 MVA and a capacitor of 60 Mvar. The values here come from that test.
grid::Grid with_compensator(const std::filesystem::path& folder) {
  const auto scratch = std::filesystem::temp_directory_path() / ("swingbank-svc-" + std::to_string(getpid()));
  std::filesystem::create_directories(scratch);
  std::ifstream given(folder / "3_BUS_System.raw");
  std::ofstream raw(scratch / "svc.raw");
  for (std::string line; std::getline(given, line);) {
    raw << line << "\n";
    if (line.find("BEGIN GENERATOR DATA") != std::string::npos)
      raw << "3, '1', 0.0, 0.0, 999.0, -999.0, 1.01500, 3, 500.0, 0.0, 9999.0, 0.0, 0.0, 1.0, 1, 100.0, 999.0, -999.0, "
             "1, 1.0\n";
  }
  std::ofstream(scratch / "svc.dyr")
      << "1 'GENCLS' 1 0 0 /\n3 'CSVGN1' 1 20 0 1 0.154833 1 0.005167 0 1 0 60 /\n";
  raw.close();
  grid::Grid grid = grid::load_grid(scratch / "svc.raw", scratch / "svc.dyr", Conventions::psse(50.0));
  std::filesystem::remove_all(scratch);
  return grid;
}

TEST(PsseRecords, Csvgn1) {
  const auto folder = test::record_folder("psse_powersimulationsdynamics") / "CSVGN1";
  const grid::Grid grid = with_compensator(folder);
  const test::Table record = test::read_table(folder / "results_PSSe.csv", false);
  network::Event event;
  event.load_steps.push_back({grid.network.bus_index(2), {-0.55, 0.0}, 0.005, {}});
  ReferenceOptions options;
  options.t_end = 0.07;
  options.rate = 1e4;
  options.channels = {Channel::V};
  options.plants = {0, 1};
  options.after_switching = true;
  const ReferenceRun run = run_reference(grid, event, options);
  const std::size_t columns[] = {grid.plants[0].name == "1" ? 1U : 3U, grid.plants[0].name == "1" ? 3U : 1U};
  double worst = 0.0;
  int seen = 0;
  for (const auto& row : record.rows) {
    const auto k = static_cast<std::size_t>(std::lround(row[0] * options.rate));
    if (k == 50 || k >= static_cast<std::size_t>(run.samples)) continue;  // switching time
    ++seen;
    for (int plant = 0; plant < 2; ++plant)
      worst = std::max(worst, std::abs(run.at(plant, 0)[k] - row[columns[plant]]));
  }
  EXPECT_GT(seen, 690);
  testing::Test::RecordProperty("worst", testing::PrintToString(worst));
  EXPECT_LT(worst, 1e-5) << worst;
}

}  // namespace
}  // namespace swingbank::sim::reference
