// Training rows of an experiment, and the runs of a preset.
#include "train/loop/experiment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "base/problem.hpp"

namespace swingbank::train::loop {
namespace {

/// An experiment with additional lines at its top, in its preset and after it.
Experiment experiment(const std::string& top, const std::string& in_preset, const std::string& behind) {
  const std::filesystem::path folder = testing::TempDir();
  for (const char* name : {"data.toml", "more.toml"}) std::ofstream(folder / name) << "\n";
  const auto file = folder / "experiment.toml";
  std::ofstream(file)
      << "title = \"t\"\ndataset = \"data.toml\"\nsplit = \"leave-one-generator-out\"\nfolds = [30, 31]\n"
      << top << "\n[preset.quick]\ndraws = 10\nchannels = [\"P\"]\nstart_s = 0\nend_s = 1\n"
      << "slice = 1\nform = \"absolute\"\npca_components = 0\nepochs = 1\nbatch = 1\n"
      << "learning_rate = 1e-3\nschedule = \"constant\"\npatience = 1\nvalidation_share = 0.1\n"
      << (in_preset.starts_with("networks") ? "" : "networks = [\"gru\", \"mlp\", \"floor\"]\n")
      << "noise = [0.0, 0.001]\n"
      << in_preset << "\n"
      << behind;
  return read_experiment(file);
}

TEST(Experiment, TrainingRowsApplyToTheNetworksThatRequestThem) {
  const Experiment e = experiment("training_dataset = \"more.toml\"", "training_draws = 5",
                                  "[preset.quick.mlp]\ntraining_rows = true\n");
  EXPECT_EQ(e.print("quick", "training_rows"), "mlp");
  EXPECT_EQ(e.print("quick", "training_draws"), "5");
  EXPECT_FALSE(e.training("quick", "gru").training_rows);
  EXPECT_EQ(experiment("", "", "").print("quick", "training_rows"), "none");
}

TEST(Experiment, TrainingRowsNeedADatasetAndEvents) {
  const std::string wanted = "[preset.quick.mlp]\ntraining_rows = true\n";
  EXPECT_THROW(experiment("", "", wanted), InputError);
  EXPECT_THROW(experiment("training_dataset = \"more.toml\"", "training_draws = 0", wanted), InputError);
}

TEST(Experiment, TasksCombineNetworkNoiseAndFoldAndAFloorNeedsNoise) {
  const Experiment e = experiment("", "", "[preset.quick.gru]\nnoise = [0.0]\ntest_rows = 7\n");
  EXPECT_EQ(
      e.print("quick", "tasks"),
      "gru 0 30\ngru 0 31\nmlp 0 30\nmlp 0 31\nmlp 0.001 30\nmlp 0.001 31\nfloor 0.001 30\nfloor 0.001 31");
  EXPECT_EQ(e.judging("quick", "gru").test_rows, 7u);
  EXPECT_EQ(e.judging("quick", "mlp").test_rows, 0u);
}

TEST(Experiment, DataFractionsRunAtTheFirstLevelAndFold) {
  const Experiment e = experiment("", "", "[preset.quick.gru]\nshares = [0.25, 0.5]\n");
  EXPECT_THAT(e.print("quick", "tasks"),
              testing::HasSubstr("gru 0.001 31\ngru 0 30 0.25\ngru 0 30 0.5\nmlp 0 30"));
  EXPECT_THROW(experiment("", "", "[preset.quick.gru]\nshares = [1.0]\n"), InputError);
}

const std::string kPhysicsAtManyLevels =
    "[preset.quick.mlp]\nform = \"physics\"\ntraining_noise = [0.0001, 0.005]\ntraining_noise_zero = 0.25\n";

TEST(Experiment, NetworksTrainedAtManyLevelsReceiveTheLevel) {
  const Experiment e = experiment("", "", kPhysicsAtManyLevels + "posterior_epochs = 2\nset_aside = 1\n");
  const TrainingRecipe& t = e.training("quick", "mlp");
  ASSERT_TRUE(t.noise_levels);
  EXPECT_EQ(t.noise_levels->high, 0.005);
  EXPECT_EQ(t.posterior_epochs, 2u);
  EXPECT_EQ(t.set_aside, 1u);
  EXPECT_TRUE(e.input("quick", "mlp").recipe.shows_level);
  EXPECT_FALSE(e.training("quick", "gru").noise_levels);
  EXPECT_THROW(experiment("", "", "[preset.quick.mlp]\ntraining_noise = [0.1, 0.01]\n"), InputError);
  EXPECT_THROW(
      experiment("", "", "[preset.quick.gru]\ntraining_noise = [0.001, 0.01]\ntraining_noise_zero = 0\n"),
      InputError);
}

TEST(Experiment, CorrectingNetworksTrainAtTheirTestLevel) {
  const std::string preset =
      kPhysicsAtManyLevels + "[preset.quick.corrects]\nlike = \"mlp\"\ncorrects = \"closed-form\"\n";
  const Experiment e = experiment("", "networks = [\"mlp\", \"corrects\"]", preset);
  EXPECT_FALSE(e.training("quick", "corrects").noise_levels);
  EXPECT_FALSE(e.input("quick", "corrects").recipe.shows_level);
  EXPECT_THROW(experiment("", "networks = [\"mlp\", \"corrects\"]", preset + "posterior_epochs = 1\n"),
               InputError);
}

TEST(Experiment, PresetsCopyACompletePreset) {
  const std::string copy =
      "[preset.night]\nlike = \"quick\"\ndraws = 99\nepochs = 70\n[preset.night.mlp]\nbatch = 9\n";
  const Experiment e = experiment("", "", kPhysicsAtManyLevels + copy);
  EXPECT_EQ(e.preset("night").draws, 99u);
  EXPECT_EQ(e.preset("night").networks, e.preset("quick").networks);
  EXPECT_EQ(e.training("night", "gru").epochs, 70u);
  EXPECT_EQ(e.training("night", "gru").batch, e.training("quick", "gru").batch);
  EXPECT_EQ(e.training("night", "mlp").batch, 9u);
  EXPECT_TRUE(e.training("night", "mlp").noise_levels);
  EXPECT_THROW(experiment("", "", "[preset.night]\nlike = \"slow\"\n"), InputError);
  EXPECT_THROW(experiment("", "", copy + "[preset.week]\nlike = \"night\"\n"), InputError);
}

TEST(Experiment, StepsStartFromAnEarlierNetworkOfNoisyRecords) {
  const std::string networks = "networks = [\"mlp\", \"steps\"]";
  const std::string steps = "[preset.quick.steps]\nsteps_from = \"mlp\"\nnoise = [0.001]\n";
  const Experiment e = experiment("", networks, kPhysicsAtManyLevels + steps);
  EXPECT_EQ(e.training("quick", "steps").steps_from, "mlp");
  EXPECT_EQ(e.training("quick", "steps").kind, "mlp");
  EXPECT_TRUE(e.training("quick", "steps").noise_levels);
  EXPECT_TRUE(e.training("quick", "mlp").steps_from.empty());
  EXPECT_THROW(
      experiment("", networks, kPhysicsAtManyLevels + "[preset.quick.steps]\nsteps_from = \"mlp\"\n"),
      InputError);  // records without noise
  EXPECT_THROW(experiment("", networks, "[preset.quick.steps]\nsteps_from = \"gru\"\nnoise = [0.001]\n"),
               InputError);  // no such network before
  EXPECT_THROW(experiment("", networks, "[preset.quick.mlp]\ncorrects = \"closed-form\"\n" + steps),
               InputError);
}

TEST(Experiment, RegressionsAndSecondsAsStepsRequireTheirInputForms) {
  const Experiment e = experiment("", "",
                                  "[preset.quick.mlp]\nform = \"physics\"\nregressions = true\n"
                                  "[preset.quick.gru]\npca_components = 3\nseconds_as_steps = true\n");
  EXPECT_TRUE(e.input("quick", "mlp").recipe.regressions);
  EXPECT_FALSE(e.input("quick", "gru").recipe.regressions);
  EXPECT_TRUE(e.input("quick", "gru").recipe.seconds_as_steps);
  EXPECT_THROW(experiment("", "", "[preset.quick.mlp]\nregressions = true\n"), InputError);
  EXPECT_THROW(experiment("", "", "[preset.quick.gru]\nseconds_as_steps = true\n"), InputError);
}

TEST(Experiment, AcrossDatasetsEveryNetworkUsesTheTrainingRows) {
  const std::filesystem::path folder = testing::TempDir();
  const auto across = [&](const std::string& rows) {
    (void)experiment("", "", "");  // writes the dataset configs that the experiment names
    std::ifstream in(folder / "experiment.toml");
    std::string text(std::istreambuf_iterator<char>(in), {});
    const std::string split = "split = \"leave-one-generator-out\"\nfolds = [30, 31]\n";
    text.replace(text.find(split), split.size(),
                 "training_dataset = \"more.toml\"\nsplit = \"across-datasets\"\n");
    text.replace(text.find("draws = 10\n"), 11, "draws = 10\ntraining_draws = 5\n" + rows);
    std::ofstream(folder / "across.toml") << text;
    return read_experiment(folder / "across.toml");
  };
  const Experiment e = across("training_rows = true\n");
  EXPECT_EQ(e.split, Split::across);
  EXPECT_EQ(e.print("quick", "training_rows"), "gru\nmlp\nfloor");
  EXPECT_EQ(e.print("quick", "tasks"),
            "gru 0 none\ngru 0.001 none\nmlp 0 none\nmlp 0.001 none\nfloor 0.001 none");
  EXPECT_THROW(across(""), InputError);
}

}  // namespace
}  // namespace swingbank::train::loop
