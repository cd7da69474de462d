// A plant whose control measures at the point of common coupling, beyond the collector.
#include <gmock/gmock.h>

#include "tests/sim/grid/far_case.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/event/point.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::validate::event {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
namespace far = sim::grid::far_control;

const std::vector<Collector> kCable = {{.R = 0.002, .X = 0.06, .B = 0.05, .ratio = 1, .mva = 100}};

TEST(PointControl, TwoPortInvertsTheCollector) {
  const std::vector<Collector> sections = {{.R = 0.01, .X = 0.05, .B = 0.02, .ratio = 0.97, .mva = 150},
                                           {.R = 0.002, .X = 0.06, .B = 0.1, .ratio = 1.03, .mva = 80}};
  record::Record at_point;
  at_point.base.mva = 100;
  at_point.t = {0.0};
  at_point.V = {1.03}, at_point.theta = {0.4}, at_point.P = {0.8}, at_point.Q = {-0.3};
  const record::Record at_units = behind_collector(at_point, sections);
  const double mva = 60, share = 0.25;  // of the unit
  const Complex V = std::polar(at_units.V[0], at_units.theta[0]);
  const Complex own = share * Complex(at_units.P[0], at_units.Q[0]) * (at_units.base.mva / mva);
  const Complex I = std::conj(own / V);
  const auto [a, b, c, d] = to_point(sections, mva, share);
  const Complex there = a * V + b * I, current = c * V + d * I, S = there * std::conj(current) * mva;
  EXPECT_NEAR(std::abs(there - std::polar(1.03, 0.4)), 0, 1e-12);
  EXPECT_NEAR(std::abs(S - Complex(80, -30)), 0, 1e-9);
}

/// A fault near the point of common coupling, recorded at the plant's own bus; the plant's control measures
/// at the point.
struct Plant : ::testing::Test {
  static constexpr double kOn = 2.0, kOff = 2.1;
  test::Simulated run = simulated();
  static test::Simulated simulated() {
    sim::formats::RawCase raw = far::behind_a_branch();
    const auto at = raw.branches.find("102,104,'1',0.0,0.08,0.0");
    raw.branches.replace(at, 24, "102,104,'1',0.002,0.06,0.05");
    return test::with_fault({far::load_from(raw, far::plants({})), kOn, kOff, {}, {}}, 103, 240, {0.0, 0.3});
  }
  [[nodiscard]] sim::plant::Plant model() const {
    sim::plant::Plant plant = run.grid.plants[1];
    plant.bus = plant.generator = -1;
    plant.far_place = {};
    plant.far.reset();
    return plant;
  }
  [[nodiscard]] double missed(const sim::plant::Plant& plant) const {
    const record::Record r = test::record_of(run, 1, 2);
    const playin::VoltageCurve curve(r, test::exact_switchings(run, 1, true));
    plant::PlantModel model;
    model.plant = plant;
    model.conventions = sim::Conventions::psse();
    model.record_base.mva = plant.mva;
    const playin::Playback p = playin::play_in(model.under_test(), r, curve);
    double worst = 0;
    for (std::size_t k = 0; k < r.t.size(); ++k)
      worst = std::max({worst, std::abs(p.P[k] - r.P[k]), std::abs(p.Q[k] - r.Q[k])});
    return worst;
  }
};

TEST_F(Plant, ControlMeasuresAtThePointOfCommonCoupling) {
  sim::plant::Plant plant = model();
  EXPECT_GT(missed(plant), 1e-3);  // with the control's measurement assumed at the plant's own bus
  MeasuredPoint point;
  point.collector = kCable;
  point.tried.plant = plant;
  EXPECT_LT(missed(at_point(point)), 1e-4);
}

TEST_F(Plant, RequiresAShareOfOtherUnits) {
  MeasuredPoint point;
  point.file = "point.toml";
  point.collector = kCable;
  point.tried.plant = model();
  point.tried.name = "the converters";
  point.others.push_back({.model = point.tried, .share = 0, .P = 20, .Q = 1});
  EXPECT_THAT(test::messages([&] { at_point(point); }), Contains(HasSubstr("measures at the common point")));
  point.others[0].share = 0.5;
  const auto beyond = at_point(point).beyond.value();
  EXPECT_NEAR(std::abs(beyond.d), 2.0, 0.01);
}

}  // namespace
}  // namespace swingbank::validate::event
