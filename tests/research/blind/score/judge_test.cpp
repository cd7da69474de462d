// The record of a case as the judge receives it.
#include "research/blind/score/judge.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "research/blind/cases/case.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/event/event.hpp"
#include "validate/fit/fit.hpp"
#include "validate/noise/pre_event.hpp"

namespace swingbank::research::blind::score {
namespace {

namespace fs = std::filesystem;

/// Residual of the right plant in the recorded channels [chi2 per value].
double left_by(const cases::BlindCase& made, const fs::path& folder) {
  SeenCase seen = read_seen_case(folder);
  seen.model.plant.machine.p = made.truth.machine.p;
  const validate::noise::WhitenedEvents events = validate::noise::whitened_events(seen.model, seen.records);
  return validate::fit::fit(seen.model.under_test(), events, {}, {.lenient = true, .errors = false})
      .reduced_chi2();
}

TEST(SeenCase, SubtractsTheSecondRecordedUnit) {
  cases::BlindConfig config = cases::load_blind_config(validate::test::source("configs/blind/tiny.toml"));
  config.conditions.second_unit_share = 1.0;
  config.channels_share = 0.0;
  const cases::BlindCase made = cases::make_blind_case(config, {.seed = 11, .index = 1});
  ASSERT_TRUE(made.other);
  EXPECT_NE(made.other->machine.p, made.truth.machine.p);
  const fs::path run = fs::path(testing::TempDir()) / ("seen_case_" + std::to_string(::getpid()));
  fs::remove_all(run);
  cases::write_blind_case(made, config, "c0001", run / "c0001", run / "truth.json");
  // Only the switching times are fitted. With the right model of the unit, the residual is little more than
  // noise.
  EXPECT_LT(left_by(made, run / "c0001"), 1.2);
  fs::remove(run / "c0001" / "point.toml");
  EXPECT_GT(left_by(made, run / "c0001"), 100.0);
  fs::remove_all(run);
}

}  // namespace
}  // namespace swingbank::research::blind::score
