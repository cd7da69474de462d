// A measured point that several units share behind one impedance: the record of one unit is recovered.
#include "validate/event/point.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "tests/validate/playin/support.hpp"
#include "validate/plant/plant_file.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::event {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

plant::PlantModel model_of(const test::Simulated& s, const std::string& name) {
  plant::PlantModel model;
  model.plant = *std::ranges::find(s.grid.plants, name, &sim::plant::Plant::name);
  model.plant.bus = model.plant.generator = -1;
  model.name = "unit " + name;
  model.conventions = sim::Conventions::psse();
  model.record_base.mva = model.plant.mva;
  return model;
}

/// Units 2 and 6 of IEEE 14 at the same bus, as recorded at the point beyond a collector.
struct TwoUnits : ::testing::Test {
  test::Simulated run = test::simulate("ieee14_genrou", sim::Conventions::psse(), 5, 2.0, 2.1, 240);
  plant::PlantModel tried = model_of(run, "2"), other = model_of(run, "6");
  record::Record alone =
      test::record_of(run,
                      static_cast<int>(std::ranges::find(run.grid.plants, "2", &sim::plant::Plant::name) -
                                       run.grid.plants.begin()),
                      2);
  const Collector section{.R = 0.004, .X = 0.06, .B = 0.03, .ratio = 1.02, .mva = 150};
  const std::vector<Collector> collector = {section};
  static constexpr double kP = 30, kQ = 10;  // of the other unit before the event [MW, Mvar]

  [[nodiscard]] record::Record seen() const {
    record::Record r = alone;
    record::Record beside = alone;
    beside.P.assign(beside.t.size(), kP / r.base.mva);
    beside.Q.assign(beside.t.size(), kQ / r.base.mva);
    auto switchings = switching::VoltageSteps(beside)
                          .find(switching::kStepThreshold / 2, switching::StepShape::either)
                          .switchings;
    for (auto& s : switchings) s.time = s.time < 2.05 ? 2.0 : 2.1;  // simulated fault times
    const playin::VoltageCurve curve(beside, switchings);
    const playin::Playback both = playin::play_in(other.under_test(), beside, curve);
    for (std::size_t k = 0; k < r.t.size(); ++k) {
      // The pi section in the reverse direction, in pu on its own base.
      const double scale = r.base.mva / section.mva;
      const Complex V = std::polar(r.V[k], r.theta[k]);
      const Complex S = Complex(r.P[k] + both.P[k], r.Q[k] + both.Q[k]) * scale;
      const Complex inner = V / section.ratio, into = std::conj(S / V) * section.ratio;
      const Complex through = into - Complex(0, section.B / 2) * inner;
      const Complex outer = inner - Complex(section.R, section.X) * through;
      const Complex out = outer * std::conj(through - Complex(0, section.B / 2) * outer) / scale;
      r.V[k] = std::abs(outer), r.theta[k] += std::arg(outer / V), r.P[k] = out.real(), r.Q[k] = out.imag();
    }
    return r;
  }
  void expect_alone(const record::Record& r) const {
    double worst = 0;
    for (std::size_t k = 0; k < r.t.size(); ++k)
      worst = std::max({worst, std::abs(r.V[k] - alone.V[k]), std::abs(r.theta[k] - alone.theta[k]),
                        std::abs(r.P[k] - alone.P[k]), std::abs(r.Q[k] - alone.Q[k])});
    EXPECT_LT(worst, 1e-4);  // with the middles of the sample intervals: 5e-3
  }
};

TEST_F(TwoUnits, RecoversTheTestedUnit) {
  const record::Record at_point = seen();
  ASSERT_GT(std::abs(at_point.P[10] - alone.P[10]), 0.1);
  const MeasuredPoint point{.file = "point.toml",
                            .collector = collector,
                            .tried = tried,
                            .others = {{.model = other, .share = 0, .P = kP, .Q = kQ}}};
  const record::Record left = of_tried_unit(point, at_point);
  expect_alone(left);
  EXPECT_THAT(left.notes, AllOf(Contains(HasSubstr("units' side of the collector")),
                                Contains(HasSubstr("power of unit 6 was subtracted; it was 30 MW"))));
}

TEST_F(TwoUnits, IntegratedAngleGetsTurnsForAllUnits) {
  const MeasuredPoint point{.file = "point.toml",
                            .collector = collector,
                            .tried = tried,
                            .others = {{.model = other, .share = 0, .P = kP, .Q = kQ}}};
  const record::Record left = of_tried_unit(point, test::by_frequency(seen(), {run.t_on, run.t_off}));
  double worst = 0;
  for (std::size_t k = 0; k < left.t.size(); ++k)
    worst = std::max({worst, std::abs(left.P[k] - alone.P[k]), std::abs(left.Q[k] - alone.Q[k])});
  EXPECT_LT(worst, 1e-5);  // without the phase jumps (turns) the machines cannot follow the angle
}
TEST_F(TwoUnits, ShareDefinesTheDispatch) {
  const record::Record inner = behind_collector(seen(), collector);
  const double share = kP / inner.base.mva / inner.P[0];
  record::Record all = inner;
  const double q = share * inner.Q[0] * inner.base.mva;
  const MeasuredPoint by_share{
      .file = "", .collector = {}, .tried = tried, .others = {{.model = other, .share = share}}};
  const MeasuredPoint by_power{
      .file = "", .collector = {}, .tried = tried, .others = {{.model = other, .share = 0, .P = kP, .Q = q}}};
  const record::Record a = of_tried_unit(by_share, all), b = of_tried_unit(by_power, all);
  for (std::size_t k = 0; k < a.t.size(); k += 50) {
    EXPECT_NEAR(a.P[k], b.P[k], 1e-4);
    EXPECT_NEAR(a.Q[k], b.Q[k], 1e-4);
  }
}

TEST_F(TwoUnits, ReadsPointFiles) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / fmt::format("swingbank-point-{}", ::getpid());
  std::filesystem::create_directories(folder);
  plant::write_plant_file(folder / "a.toml", tried, {});
  plant::write_plant_file(folder / "b.toml", other, {});
  const auto load = [&](const std::string& text) {
    std::ofstream(folder / "point.toml") << text;
    return load_point(folder / "point.toml", folder / "a.toml");
  };
  const std::string a = "[[unit]]\nmodel = \"a.toml\"\n", b = "[[unit]]\nmodel = \"b.toml\"\n";
  const MeasuredPoint point = load("[collector]\nr_pu = 0.01\nx_pu = 0.1\nbase_mva = 150\n" + a +
                                   "share = 0.6\n" + b + "P_MW = 30\nQ_Mvar = 10\n");
  ASSERT_EQ(point.collector.size(), 1U);
  EXPECT_EQ(point.collector[0].X, 0.1);
  ASSERT_EQ(point.others.size(), 1U);
  EXPECT_EQ(point.others[0].P, 30);
  EXPECT_EQ(point.others[0].model.plant.mva, other.plant.mva);
  const std::string cable = "[[collector]]\nr_pu = 0.01\nx_pu = 0.1\nbase_mva = 150\n";
  EXPECT_EQ(load(cable + cable + a).collector.size(), 2U);
  EXPECT_THAT(test::messages([&] { load(cable + "what = 2\n" + a); }),
              Contains(HasSubstr("unknown key what")));
  EXPECT_THAT(test::messages([&] { load(b + "share = 0.5\n"); }), Contains(HasSubstr("none of the units")));
  EXPECT_THAT(test::messages([&] { load(a + b + "share = 1.0\n"); }),
              Contains(HasSubstr("no power remains")));
  EXPECT_THAT(test::messages([&] { load(a + b + "P_MW = 30\nwhat = 1\n"); }),
              AllOf(Contains(HasSubstr("Q_Mvar")), Contains(HasSubstr("what"))));
  EXPECT_THAT(test::messages([&] { load(a + "[[unit]]\nmodel = \"c.toml\"\nshare = 0.1\n"); }),
              Contains(HasSubstr("c.toml")));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace swingbank::validate::event
