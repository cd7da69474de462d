// A plant whose file names the instruments of its records: fit, starts, sensitivities and errors refer to the
// plant as recorded through them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/validate/fit/cramer_rao.hpp"
#include "tests/validate/playin/instrument_example.hpp"
#include "validate/calibrate/calibrate.hpp"
#include "validate/calibrate/curve_fit.hpp"

namespace swingbank::validate::calibrate {
namespace {

using ::testing::Contains;

constexpr const char* kMoving[] = {"H", "Xdp", "Tdop", "K", "TE", "gain", "phase", "skew"};

/// The truth with some parameters 10 % off, alternately up and down; all others are fixed.
struct Wrong {
  plant::PlantModel model;
  std::vector<std::string> fixed;
  explicit Wrong(const plant::PlantModel& truth) : model(truth) {
    int sign = 1;
    for (const auto& f : chosen_parameters(truth.plant, 0.2, {})) {
      const auto name = sim::plant::parameter_record(truth.plant, f.id).name;
      if (std::ranges::find(kMoving, name) == std::end(kMoving))
        fixed.emplace_back(name);
      else
        sim::plant::parameter_value(model.plant, f.id) *= 1 + 0.1 * (sign = -sign);
    }
  }
};

class SeenThrough : public ::testing::TestWithParam<const char*> {};

TEST_P(SeenThrough, IntervalsContainTheTruth) {
  const test::InstrumentExample example({test::instrument(GetParam())});
  const Wrong wrong(example.truth);
  CalibrateOptions options;
  options.draws = options.starts = 0;
  options.fixed = wrong.fixed;
  const Calibration c = calibrate(wrong.model, example.records, options);
  EXPECT_NE(c.adequacy, Adequacy::structure_poor) << c.sentence;
  // The scores of the starts and of the fitted events agree, except for the colour of the noise.
  EXPECT_LT(std::abs(std::log(c.started.front().before / c.before)), std::log(1.5));
  std::vector<std::string> names, outside;
  std::vector<fit::FittedParameter> fitted;
  for (const CalibratedParameter& p : c.parameters) fitted.push_back(p.fit);
  const std::vector<double> bound =
      test::cramer_rao({example.truth.plant, example.truth.conventions}, c.prepared,
                       std::vector<bool>(c.prepared.size(), true), fitted);
  for (const CalibratedParameter& p : c.parameters) {
    const double truth = sim::plant::parameter_value(example.truth.plant, p.fit.where.id);
    names.emplace_back(p.fit.name);
    if (truth < p.fit.low || truth > p.fit.high) outside.emplace_back(p.fit.name);
    EXPECT_NEAR(p.fit.value, truth, 3 * p.fit.error) << p.fit.name;
    EXPECT_LT(p.fit.error, 2 * p.curvature_error) << p.fit.name;  // the residual is noise, as assumed
    EXPECT_LT(p.fit.error, 2 * bound[names.size() - 1]) << p.fit.name;
    EXPECT_GT(p.fit.error, 0.6 * bound[names.size() - 1]) << p.fit.name;
  }
  EXPECT_LE(outside.size(), 1U) << ::testing::PrintToString(outside);
  const auto& instrument = example.truth.plant.measurements.front();
  for (std::size_t i = 0; i < instrument.p.size(); ++i) {
    const std::string name(instrument.effect->parameters[i].name);
    EXPECT_THAT(names, Contains(name));
    EXPECT_THAT(outside, ::testing::Not(Contains(name)));
  }
}

INSTANTIATE_TEST_SUITE_P(Calibrate, SeenThrough,
                         ::testing::Values("CTERROR:gain=0.03,phase=-0.04", "SKEW:skew=0.008"),
                         [](const auto& which) {
                           const std::string text = which.param;
                           return text.substr(0, text.find(':'));
                         });

// A filter's window is known and never fitted.
TEST(CalibrateSeenThrough, SimulatesTheFilterWithoutFittingIt) {
  plant::PlantModel model;
  model.plant.machine = {sim::library::compiled().find("GENROU"),
                         sim::library::compiled().find("GENROU")->default_parameters()};
  model.plant.measurements = {test::instrument("PMUFILTER"), test::instrument("SKEW:skew=0.002")};
  for (const auto& f : chosen_parameters(model.plant, 0.2, {}))
    EXPECT_STRNE(sim::plant::block_effect(model.plant, f.id.block).name.data(), "PMUFILTER");
  const int last = sim::plant::block_count(model.plant) - 1;
  EXPECT_TRUE(std::ranges::any_of(chosen_parameters(model.plant, 0.2, {}),
                                  [&](const fit::FreeParameter& f) { return f.id.block == last; }));
}

TEST(CurveFitSeenThrough, SimulatesTheInstruments) {
  const test::InstrumentExample example({test::instrument("CTERROR:gain=0.03,phase=-0.04")});
  const Wrong wrong(example.truth);
  CurveFitOptions options;
  options.fixed = wrong.fixed;
  const CurveFit f = curve_fit(wrong.model, example.records, options);
  EXPECT_TRUE(f.converged) << f.sentence;
  for (const auto& p : f.parameters)
    if (p.name == "H" || p.name == "Xdp" || p.name == "phase") {
      const double truth = sim::plant::parameter_value(example.truth.plant, p.where.id);
      // Switching times are off by up to 2.7 ms; the standard error of the phase is 4 % of it.
      EXPECT_NEAR(p.value, truth, (p.name == "phase" ? 0.12 : 0.03) * std::abs(truth)) << p.name;
    }
}

}  // namespace
}  // namespace swingbank::validate::calibrate
