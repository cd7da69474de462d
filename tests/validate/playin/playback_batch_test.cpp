// Plants played back in a SIMD batch, compared with each alone.
#include "validate/playin/playback_batch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/library/library.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/playin/play_in.hpp"
#include "validate/switching/voltage_steps.hpp"

namespace swingbank::validate::playin {
namespace {

class PlaybackBatchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path configs = std::filesystem::path(SWINGBANK_SOURCE) / "configs";
    model_ = plant::load_plant_model(configs / "plants" / "ieee14_bus2.toml");
    const auto* effect = sim::library::compiled().find("SEXS");
    model_.plant.controls.push_back({effect, effect->default_parameters()});
    record_ = record::read_record(configs / "records" / "record-example" / "avr_ev1.csv", model_.record_base);
    switchings_ = switching::detect_switchings(record_);
    for (Switching& s : switchings_) s.turn = 0.1;
    curve_.emplace(record_, switchings_);
  }
  /// The plant with its exciter's gain multiplied by powers of 1.3.
  [[nodiscard]] std::vector<sim::plant::Plant> plants(int count) const {
    std::vector<sim::plant::Plant> all(static_cast<std::size_t>(count), model_.plant);
    const int K = model_.plant.controls.front().effect->parameter_index("K");
    for (int k = 0; k < count; ++k)
      all[static_cast<std::size_t>(k)].controls.front().p[static_cast<std::size_t>(K)] *= std::pow(1.3, k);
    return all;
  }
  [[nodiscard]] PlaybackRun run(const sim::plant::Plant& plant) const {
    return {.plant = &plant,
            .conventions = model_.conventions,
            .record = &record_,
            .curve = &*curve_,
            .start = pre_event_point(record_, switchings_, 1.0),
            .tolerance = 1e-5,
            .least_step = record_.step() / 40};
  }
  plant::PlantModel model_;
  record::Record record_;
  std::vector<Switching> switchings_;
  std::optional<VoltageCurve> curve_;
};

/// At a tolerance of 1e-5 per step, batch and single playback differed by at most 1.9e-4.
TEST_F(PlaybackBatchTest, AgreesWithSinglePlants) {
  const auto all = plants(11);  // more than the size of a SIMD batch
  std::vector<PlaybackRun> runs;
  for (const auto& plant : all) runs.push_back(run(plant));
  const auto responses = simulate_playback_batch(runs);
  ASSERT_EQ(responses.size(), all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    ASSERT_TRUE(responses[k].has_value()) << k;
    const Response own = simulate_playback(runs[k]);
    for (const Output o : {Output::P, Output::Q, Output::speed, Output::Efd, Output::V}) {
      ASSERT_EQ(responses[k]->of(o).size(), own.of(o).size());
      for (std::size_t s = 0; s < own.of(o).size(); ++s)
        EXPECT_NEAR(responses[k]->of(o)[s], own.of(o)[s], 3e-4) << output_name(o) << " of run " << k;
    }
    if (k > 0) {
      EXPECT_GT(std::abs(responses[k]->of(Output::Q)[300] - responses[0]->of(Output::Q)[300]), 2e-3) << k;
    }
  }
}
TEST_F(PlaybackBatchTest, ReturnsNothingForInfeasibleOperatingPoints) {
  auto all = plants(3);
  const int EMAX = model_.plant.controls.front().effect->parameter_index("EMAX");
  std::vector<PlaybackRun> runs;
  for (auto& plant : all) {
    plant.controls.front().p[static_cast<std::size_t>(EMAX)] = 0.5;  // below the initial Efd
    runs.push_back(run(plant));
    runs.back().allowance.assign(16, 1.0);  // as in a search, from its first plant
  }
  for (const auto& response : simulate_playback_batch(runs)) EXPECT_FALSE(response.has_value());
}
TEST_F(PlaybackBatchTest, InfeasiblePlantDoesNotAffectTheOthers) {
  auto all = plants(4);
  const int EMAX = model_.plant.controls.front().effect->parameter_index("EMAX");
  for (const std::size_t k : {std::size_t{0}, std::size_t{2}})
    all[k].controls.front().p[static_cast<std::size_t>(EMAX)] = 0.5;  // below the initial Efd
  std::vector<PlaybackRun> runs;
  for (const auto& plant : all) runs.push_back(run(plant));
  const auto responses = simulate_playback_batch(runs);
  for (std::size_t k = 0; k < all.size(); ++k) EXPECT_EQ(responses[k].has_value(), k % 2 == 1) << k;
  EXPECT_TRUE(simulate_playback_batch({}).empty());
}

}  // namespace
}  // namespace swingbank::validate::playin
