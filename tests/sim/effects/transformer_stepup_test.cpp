// Plant behind STEPUP against the same plant at its own bus behind an equal transformer branch.
#include "sim/batch/batch.hpp"
#include "sim/library/library.hpp"
#include "tests/sim/reference/reference_support.hpp"

namespace swingbank::sim::effects {
namespace {

constexpr double kMva = 150.0, kR = 0.004, kX = 0.12, kRatio = 1.05;

network::Branch line(int from, int to, const char* circuit) {
  network::Branch b{};
  b.from = from;
  b.to = to;
  b.circuit = circuit;
  b.r = 0.01;
  b.x = 0.12;
  b.b = 0.02;
  return b;
}
network::Generator machine(int bus, double p, double vset, double mva, double zx) {
  network::Generator g{};
  g.bus = bus;
  g.id = "1";
  g.p = p;
  g.vset = vset;
  g.mva = mva;
  g.zx = zx;
  return g;
}

/// Bus 1: infinite bus, bus 2: grid's side of the transformer, bus 3 (only with `branch`): machine.
network::Network network(bool branch) {
  network::Network net;
  net.title = net.origin = branch ? "transformer as a branch" : "transformer in the plant";
  net.buses = {{1, "INFINITE", 138.0, network::BusType::slack, 1.02, 0.0},
               {2, "GRID", 138.0, network::BusType::load, 1.0, 0.0}};
  network::Load load{};
  load.bus = 1;
  load.id = "1";
  load.power = {0.5, 0.1};
  net.loads = {load};
  net.branches = {line(0, 1, "1"), line(0, 1, "2")};
  if (branch) {
    net.buses.push_back({3, "MACHINE", 20.0, network::BusType::generator, 1.0, 0.0});
    network::Branch t{};
    t.from = 1;  // the ideal ratio is at the branch's `from` side, here the grid's
    t.to = 2;
    t.circuit = "1";
    t.r = kR * 100.0 / kMva;
    t.x = kX * 100.0 / kMva;
    t.tap = kRatio;
    net.branches.push_back(t);
  }
  net.generators = {machine(0, 0.0, 1.02, 100.0, 1e-4), machine(branch ? 2 : 1, 0.9, 1.01, kMva, 0.25)};
  return net;
}
const formats::DyrRecord kGenrou = {
    0, "GENROU", "1", {8.0, 0.03, 0.4, 0.05, 6.175, 0.05, 1.8, 1.7, 0.3, 0.55, 0.25, 0.2, 0.1, 0.8}, 2};
/// Machine whose current is a nonlinear function of the voltage.
const formats::DyrRecord kGentpj = {
    0,
    "GENTPJU1",
    "1",
    {7.0, 0.04, 0.8, 0.06, 5.0, 0.05, 1.8, 1.7, 0.3, 0.55, 0.25, 0.27, 0.15, 0.1, 0.4, 0.05},
    2};
std::vector<formats::DyrRecord> models(int bus, formats::DyrRecord machine = kGenrou) {
  machine.bus = bus;
  return {{1, "GENCLS", "1", {0.0, 0.0}, 1}, machine};
}

struct Pair {
  grid::Grid branch, plant;
};
/// Both grids at the same power flow: the plant delivers the branch flow into bus 2.
Pair grids(Conventions conventions, const formats::DyrRecord& machine = kGenrou) {
  Pair pair{grid::make_grid(network(true), models(3, machine), "branch", conventions), {}};
  const auto& v = pair.branch.flow.voltage;
  const Complex z(kR * 100.0 / kMva, kX * 100.0 / kMva);
  const Complex current = (v[2] - v[1] / kRatio) / z / kRatio;
  const Complex power = v[1] * std::conj(current);
  network::Network net = network(false);
  net.buses[1].type = network::BusType::generator;
  net.generators[1].p = power.real();
  net.generators[1].vset = std::abs(v[1]);
  pair.plant = grid::make_grid(std::move(net), models(2, machine), "plant", conventions);
  pair.plant.plants[1].transformer = {library::compiled().find("STEPUP"), {kR, kX, kRatio}};
  return pair;
}

reference::ReferenceRun reference(const grid::Grid& grid, std::vector<Channel> channels) {
  reference::ReferenceOptions options;
  options.t_end = 5.0;
  options.plants = {1};
  options.channels = std::move(channels);
  options.buses = {1};
  return reference::run_reference(grid, network::Event{{{1, 1.0, 1.1, {0.0, 0.05}}}, {}}, options);
}

TEST(TransformerStepup, EqualsTheSameTransformerAsABranch) {
  const std::pair<Conventions, formats::DyrRecord> cases[] = {{Conventions::psse(), kGenrou},
                                                              {Conventions::andes(), kGenrou},
                                                              {Conventions::psse(), kGentpj},
                                                              {Conventions::andes(), kGentpj}};
  for (const auto& [conventions, machine] : cases) {
    const Pair pair = grids(conventions, machine);
    EXPECT_NEAR(std::abs(pair.plant.flow.voltage[1] - pair.branch.flow.voltage[1]), 0.0,
                1e-10);  // power flow
    const auto inside = {Channel::delta, Channel::speed, Channel::Ifd};
    const reference::ReferenceRun a = reference(pair.branch, inside), b = reference(pair.plant, inside);
    double moved = 0.0;
    for (int k = 0; k < a.samples; ++k) moved = std::max(moved, std::abs(a.at(0, 0)[k] - a.at(0, 0)[0]));
    EXPECT_GT(moved, 0.05);  // there is a swing to compare [rad]
    // Two runs of IDA at rtol 1e-8 with different unknowns: each errs by some 1e-7 after thousands of steps.
    EXPECT_LE(test::largest_difference(a, b), 1e-6);
    for (int k = 0; k < a.samples; ++k) {
      EXPECT_NEAR(a.bus_v[k], b.bus_v[k], 1e-6);
      EXPECT_NEAR(a.bus_theta[k], b.bus_theta[k], 1e-6);
    }
  }
}

TEST(TransformerStepup, RecordsTheGridsSide) {
  const Pair pair = grids(Conventions::psse());
  const reference::ReferenceRun run = reference(pair.plant, {Channel::V, Channel::P, Channel::Q});
  for (int k = 0; k < run.samples; ++k) EXPECT_NEAR(run.at(0, 0)[k], run.bus_v[k], 1e-12);
  const Complex power = pair.plant.plants[1].generation * (100.0 / kMva);
  EXPECT_NEAR(run.at(0, 1)[0], power.real(), 1e-9);
  EXPECT_NEAR(run.at(0, 2)[0], power.imag(), 1e-9);
}

TEST(TransformerStepup, NullValuesChangeNothing) {
  grid::Grid with = grid::make_grid(network(true), models(3), "neutral", Conventions::psse());
  const reference::ReferenceRun without = reference(with, {});
  with.plants[1].transformer = {library::compiled().find("STEPUP"), {0.0, 0.0, 1.0}};
  // The same equations in another order of operations.
  EXPECT_LE(test::largest_difference(reference(with, {}), without), 1e-8);
}

TEST(TransformerStepup, RefusesInvalidTransformers) {
  const double wrong[] = {-0.01, -0.1, 0.0};
  Problems problems;
  library::compiled().find("STEPUP")->check(nullptr, wrong, "here", problems);
  ASSERT_EQ(problems.list().size(), 3u);
  EXPECT_EQ(problems.list()[1].sentence(),
            "X = -0.1 pu at here (a leakage reactance cannot be negative): give X >= 0");
}

}  // namespace
}  // namespace swingbank::sim::effects
