#include "sim/grid/grid.hpp"

#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <bit>
#include <cmath>
#include <cstdlib>

#include "sim/grid/unit.hpp"
#include "sim/plant/equations.hpp"
#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::grid {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kRound = "8.0 0.03 0.4 0.05 6.175 0.05 1.8 1.7 0.3 0.55 0.25 0.2 0.1 0.8";
std::string plain_dyr() { return "101 'GENCLS' 1 0.0 0.0 /\n102 'GENROU' 1 " + kRound + " /\n"; }

Grid load(const formats::RawCase& raw, const std::string& dyr,
          Conventions conventions = Conventions::psse()) {
  const formats::ScratchFile r("case.raw", raw.text()), d("case.dyr", dyr);
  return load_grid(r.path, d.path, conventions);
}
std::string complaints(const formats::RawCase& raw, const std::string& dyr) {
  return formats::sentences_of([&] { load(raw, dyr); });
}
std::string configs(const std::string& name) {
  return std::string(SWINGBANK_SOURCE) + "/configs/networks/" + name;
}
double parameter(const plant::Block& block, const char* name) {
  return block.p.at(static_cast<std::size_t>(block.effect->parameter_index(name)));
}

TEST(Grid, JoinsGeneratorsAndModels) {
  formats::RawCase raw;
  raw.header_rest = ", 0, 1, 50.0";
  const Grid grid = load(raw, plain_dyr());
  EXPECT_EQ(grid.conventions.frequency, 50.0);  // from the network
  ASSERT_EQ(grid.plants.size(), 2u);
  EXPECT_EQ(grid.plants[0].name, "101");
  EXPECT_EQ(grid.plants[0].machine.effect->name, "GENCLS");
  EXPECT_EQ(parameter(grid.plants[0].machine, "Xdp"), 0.3);  // ZX of the .raw
  const plant::Block& round = grid.plants[1].machine;
  EXPECT_EQ(round.effect->name, "GENROU");
  EXPECT_EQ(parameter(round, "Tdop"), 8.0);
  EXPECT_EQ(parameter(round, "S12"), 0.8);
  EXPECT_EQ(parameter(round, "Ra"), 0.0);
  EXPECT_EQ(grid.plants[1].generation, grid.flow.generation[1]);
  EXPECT_EQ(grid.plants[1].generator, 1);
}

TEST(Grid, SeveralMachinesAtABusKeepTheirIds) {
  formats::RawCase raw;
  raw.generators +=
      "102,'B',50.0,0,100,-100,1.02,0,50,0.002,0.4,0,0,1,1\n"
      "102,'C',50.0,0,100,-100,1.02,0,50,0,0.4,0,0,1,0\n";
  const Grid grid = load(raw, plain_dyr() + "102 'GENCLS' 'B' 3.0 1.0 /\n102 'GENCLS' 'C' 3.0 1.0 /\n");
  ASSERT_EQ(grid.plants.size(), 3u);  // C is out of service, its model is no error
  EXPECT_EQ(grid.plants[1].name, "102/1");
  EXPECT_EQ(grid.plants[2].name, "102/B");
  EXPECT_EQ(parameter(grid.plants[2].machine, "Ra"), 0.002);
  EXPECT_EQ(grid.plants[2].mva, 50.0);
}

TEST(Grid, ReportsAllErrorsWithTheDyrLine) {
  formats::RawCase raw;
  raw.generators += "102,'B',50.0,0,100,-100,1.02,0,50,0,0.4,0,0,1,1\n";
  const std::string all =
      complaints(raw, "101 'GENCLS' 1 0.0 /\n101 'GENFOO' 1 1 2 /\n102 'GENROU' 1 " + kRound +
                          " /\n102 'GENCLS' 1 3 0 /\n103 'GENCLS' 1 3 0 /\n102 'GENCLS' X 3 0 /\n");
  EXPECT_THAT(all, HasSubstr("GENCLS with 1 parameters at "));
  EXPECT_THAT(all, HasSubstr("it takes 2: H D"));
  EXPECT_THAT(all, HasSubstr("case.dyr:1"));
  EXPECT_THAT(all, HasSubstr("unknown model 'GENFOO' of '1' at bus 101"));
  EXPECT_THAT(all, HasSubstr("GENCLS, GENQEC, GENROE, GENROU"));
  EXPECT_THAT(all, HasSubstr("case.dyr:2"));
  EXPECT_THAT(all, HasSubstr("a second machine model, GENCLS, for generator 102/1"));
  EXPECT_THAT(all, HasSubstr("case.dyr:4"));
  EXPECT_THAT(all, HasSubstr("no machine model for generator 'B' at bus 102"));
  EXPECT_THAT(all, HasSubstr("--net-generators"));
}

TEST(Grid, ReportsErrorsOfRawAndDyrTogether) {
  formats::RawCase raw;
  raw.loads = "999,'1',1,1,1,250.0,30.0\n";
  const std::string all = complaints(raw, "101 'GENCLS'\n");
  EXPECT_THAT(all, HasSubstr("bus 999"));
  EXPECT_THAT(all, HasSubstr("incomplete record"));
}

TEST(Grid, InconsistentReactancesAreRefused) {
  const std::string all = complaints({},
                                     "101 'GENCLS' 1 -1.0 0.0 /\n102 'GENROU' 1 8.0 0.03 0.4 0.05 6.175 0.05 "
                                     "1.8 1.7 0.15 0.55 0.25 0.2 0.4 0.3 /\n");
  EXPECT_THAT(all, HasSubstr("H = -1"));
  EXPECT_THAT(all, HasSubstr("X'd = 0.15"));
  EXPECT_THAT(all, HasSubstr("S1.0 = 0.4"));
  EXPECT_THAT(all, HasSubstr("case.dyr:2"));
}

/// Log output of spdlog during an action.
std::string logged(const std::function<void()>& action) {
  std::ostringstream out;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(out)));
  action();
  spdlog::set_default_logger(before);
  return out.str();
}

TEST(Grid, ASourceReactanceThatContradictsTheDyrIsMentioned) {
  EXPECT_THAT(logged([] { load({}, plain_dyr()); }), Not(HasSubstr("ZX")));  // ZX 0.25 = X''d
  formats::RawCase other, absent;
  other.generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3\n102,'1',100.0,-3.0,100,-100,1.02,0,100,0,0.2\n";
  absent.generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3\n102,'1',100.0,-3.0,100,-100,1.02,0,100,0,0\n";
  const std::string text = logged([&] { load(other, plain_dyr()); });
  EXPECT_THAT(text, HasSubstr("case.dyr:2"));
  EXPECT_THAT(text, HasSubstr("ZX = 0.2 pu"));
  EXPECT_THAT(text, HasSubstr("0.25 pu in its GENROU"));
  EXPECT_THAT(logged([&] { load(absent, plain_dyr()); }), Not(HasSubstr("ZX")));
}

TEST(Grid, DyrReadsBackToTheLastBit) {
  Grid grid = load_grid(configs("ieee39_genrou.raw"), configs("ieee39_genrou.dyr"), Conventions::psse());
  double awkward = 1.0 / 3.0;
  for (plant::Plant& plant : grid.plants)
    for (const int column : plant.machine.effect->dyr_columns)
      plant.machine.p[static_cast<std::size_t>(column)] *=
          1.0 + 1e-5 * (awkward = std::fmod(awkward * 7.3, 1.0));
  std::string text;
  Problems problems;
  for (const plant::Plant& plant : grid.plants) {
    const network::Generator& g = grid.network.generators[static_cast<std::size_t>(plant.generator)];
    const int bus = grid.network.buses[static_cast<std::size_t>(plant.bus)].number;
    text += unit_dyr(plant, bus, g.id, plant.name, problems);
  }
  const formats::ScratchFile file("out.dyr", text);
  const Grid again =
      make_grid(grid.network, formats::read_dyr(file.path), file.path.string(), grid.conventions);
  ASSERT_EQ(again.plants.size(), grid.plants.size());
  for (std::size_t k = 0; k < grid.plants.size(); ++k)
    for (std::size_t i = 0; i < grid.plants[k].machine.p.size(); ++i)
      EXPECT_EQ(std::bit_cast<std::uint64_t>(again.plants[k].machine.p[i]),
                std::bit_cast<std::uint64_t>(grid.plants[k].machine.p[i]));
}

class OperatingPoints : public ::testing::TestWithParam<const char*> {};
TEST_P(OperatingPoints, AreSteadyAndFeedTheNetwork) {
  for (const Conventions& conventions : {Conventions::psse(), Conventions::andes()}) {
    const Grid grid = load_grid(configs(std::string(GetParam()) + ".raw"),
                                configs(std::string(GetParam()) + ".dyr"), conventions);
    for (const plant::Plant& plant : grid.plants) {
      const Complex v = grid.flow.voltage[static_cast<std::size_t>(plant.bus)];
      const plant::Operating o = plant::operating_point(plant, v, grid.network.base_mva, grid.conventions);
      // The derivative again, by the contract of effects only: emf, network current, electrical, derivative.
      const auto& machine = plant.machine.effect->get<double>().machine;
      std::vector<double> scratch(static_cast<std::size_t>(plant.machine.effect->scratch)), dx(o.x.size());
      double er = 0.0, ei = 0.0;
      machine.emf(o.c.data(), o.x.data(), scratch.data(), er, ei);
      Signals<double> s = o.s;
      double r = 0.0, x = 0.0;
      machine.source_impedance(plant.machine.p.data(), r, x);
      const Complex i = (Complex(er, ei) - v) / Complex(r, x);
      s.Ir = i.real();
      s.Ii = i.imag();
      s.Efd = o.Efd;
      s.Tm = o.Tm;
      machine.electrical(o.c.data(), o.x.data(), scratch.data(), s);
      machine.derivative(o.c.data(), o.x.data(), scratch.data(), s, dx.data());
      for (const double d : dx)
        EXPECT_LT(std::abs(d), 1e-10) << plant.name;  // rounding of order 1 terms times 1/T'' up to 30/s
      EXPECT_NEAR(std::abs(v * std::conj(i) * (plant.mva / 100.0) - plant.generation), 0.0, 1e-11);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Committed, OperatingPoints,
                         ::testing::Values("ieee14_genrou", "ieee39_gencls", "ieee39_genrou",
                                           "ieee14_dataset_genrou", "ieee39_dataset_gencls",
                                           "ieee39_dataset_genrou"));

TEST(OperatingPoint, HasTheReferencesStatesAndFieldVoltage) {
  // IEEE 14, generator 1, from the initial state in the JSON of the ANDES record; saturated. ANDES started
  // from its own power flow, balanced to 4e-7 pu.
  constexpr double tolerance = 1e-6;
  const Grid grid =
      load_grid(configs("ieee14_genrou.raw"), configs("ieee14_genrou.dyr"), Conventions::andes());
  const plant::Plant& plant = grid.plants[0];
  const plant::Operating o = plant::operating_point(plant, grid.flow.voltage[0], 100.0, grid.conventions);
  EXPECT_NEAR(o.x[0], 0.4369258742721077, tolerance);
  EXPECT_NEAR(o.Efd, 1.3218571157442656, tolerance);
  EXPECT_NEAR(o.s.Ifd, 1.3218571157442645, tolerance);
  EXPECT_NEAR(o.Tm, 2.3239327730935737 / 6.15, tolerance);
  EXPECT_NEAR(o.x[2], 1.0090023676343605, tolerance);             // E'q
  EXPECT_NEAR(o.x[4], 0.9795973618827838, tolerance);             // psi1d, called e2d in ANDES
  EXPECT_NEAR(std::abs(o.x[5]), 0.39848465513678144, tolerance);  // psi2q: the sign is a convention
}

TEST(OperatingPoint, OfAnInfiniteBusIsSteady) {
  const Grid grid = load({}, plain_dyr());
  const plant::Operating o =
      plant::operating_point(grid.plants[0], grid.flow.voltage[0], 100.0, grid.conventions);
  EXPECT_EQ(o.x[1], 0.0);
  const plant::PlantEquations<double> equations(grid.plants[0]);
  EXPECT_EQ(equations.impedance(o.c.data())[1], 0.3);
}

TEST(OperatingPoint, AnImpossiblePointNamesThePlant) {
  const Grid grid = load({}, plain_dyr());
  const std::string text =
      formats::sentences_of([&] { plant::operating_point(grid.plants[1], 0.0, 100.0, grid.conventions); });
  EXPECT_THAT(text, HasSubstr("generator 102"));
}

/// Published PSS/E cases beside the checkout or in the folder SWINGBANK_REFERENCE. They must not be
/// committed here, so these tests exist only if the files do.
std::filesystem::path reference() {
  const char* folder = std::getenv("SWINGBANK_REFERENCE");
  return std::filesystem::path(folder ? folder : std::string(SWINGBANK_SOURCE) + "/../shared/reference") /
         "psse";
}
class PublishedPsse : public ::testing::TestWithParam<std::filesystem::path> {};
TEST_P(PublishedPsse, ReadsAndSolvesNearTheStoredVoltages) {
  const network::Network n = formats::read_raw(GetParam());
  const network::PowerFlow flow = network::solve_power_flow(n);
  EXPECT_LE(flow.mismatch, 1e-12);
  for (std::size_t i = 0; i < n.buses.size(); ++i)  // the file gives five digits of V, and degrees to 1e-4
    EXPECT_LT(std::abs(flow.voltage[i] - std::polar(n.buses[i].vm, n.buses[i].va)), 2e-5)
        << n.buses[i].number;
}
std::vector<std::filesystem::path> published() {
  std::vector<std::filesystem::path> found;
  for (const char* name : {"GENROU/ThreeBusMulti.raw", "EXST1/TVC_System_32.raw"})
    if (std::filesystem::exists(reference() / name)) found.push_back(reference() / name);
  return found;
}
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(PublishedPsse);
INSTANTIATE_TEST_SUITE_P(Files, PublishedPsse, ::testing::ValuesIn(published()),
                         [](const auto& test) { return test.param.stem().string(); });

TEST(Grid, ModelsThatAreNotAvailableAreAllNamedAndCanBeIgnoredOrMapped) {
  const formats::RawCase raw;
  const formats::ScratchFile r("case.raw", raw.text());
  const std::string round = kRound;
  const formats::ScratchFile d("case.dyr", "101 'GENCLS' 1 0.0 0.0 /\n102 'GENROX' 1 " + round +
                                               " /\n102 'IEEEX9' 1 1 2 3 /\n102 'USRMDL' 1 'MYGOV' 5 0 /\n");
  const auto load_with = [&](const formats::DyrOptions& options) {
    return load_grid(r.path, d.path, Conventions::psse(), options);
  };
  const std::string all = formats::sentences_of([&] { load_with({}); });
  for (const char* part : {"unknown model 'GENROX'", "case.dyr:2", "unknown model 'IEEEX9'", "case.dyr:3",
                           "--ignore-model IEEEX9", "user-written model 'MYGOV'", "case.dyr:4",
                           "--map-model GENROX=OTHER", "with 14 parameters"})
    EXPECT_THAT(all, HasSubstr(part));
  formats::DyrOptions options{{"IEEEX9", "MYGOV"}, {{"GENROX", "GENROU"}}};
  const Grid grid = load_with(options);
  EXPECT_EQ(grid.plants[1].machine.effect->name, "GENROU");
  EXPECT_TRUE(grid.plants[1].controls.empty());
  options.map = {{"GENROX", "GENCLS"}};  // takes two parameters, not fourteen
  EXPECT_THAT(formats::sentences_of([&] { load_with(options); }), HasSubstr("GENCLS with 14 parameters"));
}

TEST(Grid, MatpowerCaseUsesTheCallersFrequency) {
  const formats::ScratchFile m(
      "two.m",
      "mpc.version = '2';\nmpc.baseMVA = 100;\n"
      "mpc.bus = [1 3 0 0 0 0 1 1 0 110 1 1.1 0.9; 2 2 50 10 0 0 1 1 0 110 1 1.1 0.9];\n"
      "mpc.gen = [1 0 0 9 -9 1 100 1 9 0; 2 40 0 9 -9 1 100 1 9 0];\n"
      "mpc.branch = [1 2 0.01 0.1 0 0 0 0 0 0 1];\n"),
      d("two.dyr", "1 'GENROU' 1 " + kRound + " /\n2 'GENROU' 1 " + kRound + " /\n"),
      classical("two.dyr", "1 'GENCLS' 1 3.0 0.0 /\n2 'GENROU' 1 " + kRound + " /\n");
  EXPECT_EQ(load_grid(m.path, d.path, Conventions::psse(), {}, 50.0).conventions.frequency, 50.0);
  EXPECT_THAT(formats::sentences_of([&] { load_grid(m.path, d.path, Conventions::psse()); }),
              HasSubstr("no frequency"));
  // The case has no machine impedance, from which the model would take its X'd.
  EXPECT_THAT(
      formats::sentences_of([&] { load_grid(m.path, classical.path, Conventions::psse(), {}, 50.0); }),
      HasSubstr("X'd = 0"));
}

}  // namespace
}  // namespace swingbank::sim::grid
