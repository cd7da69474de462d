// Playback of staged tests: steps of references on the grid, load rejection, a step in an open circuit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/validate/playin/staged_case.hpp"
#include "validate/playin/component.hpp"
#include "validate/playin/play_in.hpp"

namespace swingbank::validate::playin {
namespace {

using Staged = record::StagedEvent::Kind;
using Controls = std::vector<std::string>;

/// Largest error of an output against the record, and its range in the record [pu].
struct StagedError {
  double error = 0, moved = 0;
};
StagedError staged_error(const sim::plant::PlantUnderTest& tested, const record::Record& r, Output output) {
  const std::vector<Switching> none;
  const VoltageCurve curve(
      r, r.breaker() && !r.open_circuit() ? std::vector<Switching>{{.time = r.breaker()->time}} : none);
  const Playback back = play_in(tested, r, curve);
  const std::vector<double>* responses[kOutputs] = {&back.P,   &back.Q,  &back.speed, &back.Efd,
                                                    &back.Ifd, &back.Pm, &back.gate,  &back.V};
  const auto& response = *responses[static_cast<int>(output)];
  const auto& measured = output_of(r, output);
  StagedError e;
  for (std::size_t k = 0; k < response.size(); ++k) {
    e.error = std::max(e.error, std::abs(response[k] - measured[k]));
    e.moved = std::max(e.moved, std::abs(measured[k] - measured.front()));
  }
  return e;
}

TEST(StagedTest, StepOfTheVoltageReferenceOnTheGrid) {
  const auto c = test::simulated_staged({"SEXS", "TGOV1"}, {.dVref = 0.03});
  record::Record r = test::staged_record(c, {{Staged::vref_step, 1.0, 1e5, 0.03}});
  for (const Output o : {Output::Q, Output::Efd}) {
    const StagedError e = staged_error({c.plant(), c.grid.conventions}, r, o);
    EXPECT_GT(e.moved, 0.05);
    EXPECT_LT(e.error, 1e-3 * e.moved) << output_name(o);
  }
  r.staged.clear();
  EXPECT_GT(staged_error({c.plant(), c.grid.conventions}, r, Output::Efd).error, 0.1);
}

TEST(StagedTest, StepOfThePowerReferenceOnTheGrid) {
  const auto c = test::simulated_staged({"SEXS", "TGOV1"}, {.dPref = -0.05});
  record::Record r = test::staged_record(c, {});
  r.staged = {{Staged::pref_step, 1.0, 1e5, -0.05 * c.plant().mva / r.base.mva}};
  const StagedError e = staged_error({c.plant(), c.grid.conventions}, r, Output::Pm);
  EXPECT_GT(e.moved, 0.1);
  EXPECT_LT(e.error, 1e-3 * e.moved);
}

TEST(StagedTest, LoadRejectionSimulatesTheVoltage) {
  for (const std::string machine : {"GENROU", "GENTPJ"}) {
    const auto c = test::simulated_staged({"SEXS", "TGOV1"}, {.open = 1.0021, .end = 6, .machine = machine});
    const record::Record r = test::staged_record(c, {{Staged::load_rejection, 1.0021}});
    for (const Output o : {Output::V, Output::Efd, Output::Ifd, Output::speed}) {
      const StagedError e = staged_error({c.plant(), c.grid.conventions}, r, o);
      EXPECT_GT(e.moved, 0.01) << machine << " " << output_name(o);
      EXPECT_LT(e.error, 1e-4 * e.moved) << machine << " " << output_name(o);
    }
  }
}

TEST(StagedTest, StepInOpenCircuit) {
  const record::Record r = test::open_circuit_record(0.05);
  const sim::plant::Plant plant = test::unloaded_plant();
  const sim::Conventions conventions = sim::Conventions::psse();
  for (const Output o : {Output::V, Output::Efd, Output::Ifd}) {
    const StagedError e = staged_error({plant, conventions}, r, o);
    EXPECT_GT(e.moved, 0.04) << output_name(o);
    EXPECT_LT(e.error, 1e-7) << output_name(o);
  }
}

}  // namespace
}  // namespace swingbank::validate::playin
