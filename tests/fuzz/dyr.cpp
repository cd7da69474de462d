// PSS/E .dyr: bytes -> models of a fixed grid of three machines, a load and a switched shunt -> operating
// point.
#include "sim/grid/grid.hpp"
#include "sim/plant/load_equations.hpp"
#include "tests/fuzz/check.hpp"

namespace {

const char* const kGrid =
    "0, 100, 33, 0, 0, 60\none\ntwo\n"
    "1,'A',110,3,1,1,1,1.02,0\n2,'B',110,2,1,1,1,1.01,0\n3,'C',20,2,1,1,1,1.0,0\n4,'D',110,1,1,1,1,1,0\n0\n"
    "4,'1',1,1,1,180,60\n0\n0\n"
    "1,'1',60,10,99,-99,1.02,0,100,0,0.3\n2,'1',70,10,99,-99,1.01,0,100,0.002,0.25\n"
    "3,'1',50,10,99,-99,1.0,0,80,0,0.2\n0\n"
    "1,4,'1',0.01,0.08,0.02\n2,4,'1',0.01,0.1,0.02\n1,2,'1',0.02,0.15,0.03\n0\n"
    "3,4,0,'1'\n0,0.1\n1\n1\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n"
    "4,2,0,1,1.1,0.9,0,100,'',20,2,10,1,-10\n0\nQ\n";

void check(const std::vector<double>& values, const char* what) {
  for (const double v : values) swingbank::fuzz::require(std::isfinite(v), what);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  static const sim::network::Network network = sim::formats::parse_raw(kGrid, "grid");
  const std::string text(reinterpret_cast<const char*>(data), size);
  sim::grid::Grid grid;
  if (!fuzz::accepted([&] {
        grid = sim::grid::make_grid(network, sim::formats::parse_dyr(text, "case.dyr"), "case.dyr",
                                    sim::Conventions::psse());
      }))
    return 0;
  for (const sim::plant::Plant& plant : grid.plants) {
    sim::plant::Operating point;
    if (!fuzz::accepted([&] {
          point = sim::plant::operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                                              grid.network.base_mva, grid.conventions);
        }))
      continue;
    check(point.x, "states are finite");
    check(point.c, "coefficients are finite");
    check({point.Efd, point.Tm}, "field voltage and torque are finite");
  }
  for (const sim::plant::Consumer& load : grid.loads) {
    const auto voltage = [&](int bus) { return grid.flow.voltage[static_cast<std::size_t>(bus)]; };
    (void)fuzz::accepted([&] {
      (void)sim::plant::load_operating_point(load, load.block.p, voltage(load.bus), grid.network.base_mva,
                                             grid.conventions,
                                             voltage(load.regulated < 0 ? load.bus : load.regulated));
    });
  }
  return 0;
}
