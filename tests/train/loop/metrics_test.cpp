#include "train/loop/metrics.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "base/problem.hpp"
#include "train/loop/experiment.hpp"

namespace swingbank::train::loop {
namespace {

TEST(Metrics, MatchHandCalculatedValues) {
  // Two rows; H true 2 and 4, D true 1 and 1, X constant.
  const std::vector<double> truth = {2.0, 1.0, 0.3, 4.0, 1.0, 0.3},
                            predicted = {3.0, 1.5, 0.3, 4.0, 0.5, 0.3}, mean = {5.0, 2.0, 0.3};
  const Score s =
      score({predicted, truth, mean, {"H", "D", "X"}, {"s", "pu", "pu"}, {1.0, 0.0, 0.3}, {10.0, 3.0, 0.3}});
  EXPECT_DOUBLE_EQ(s.parameters[0].mse, 0.5);            // (1 + 0) / 2
  EXPECT_DOUBLE_EQ(s.parameters[0].baseline_mse, 5.0);   // (9 + 1) / 2
  EXPECT_DOUBLE_EQ(s.parameters[0].variance, 1.0);       // of 2 and 4
  EXPECT_DOUBLE_EQ(s.parameters[0].box_variance, 6.75);  // 9^2 / 12
  EXPECT_DOUBLE_EQ(*s.parameters[0].relative(), 0.5);
  EXPECT_DOUBLE_EQ(s.parameters[1].mse, 0.25);
  EXPECT_DOUBLE_EQ(s.parameters[1].baseline_mse, 1.0);
  EXPECT_FALSE(s.parameters[1].relative());  // both rows have D = 1
  EXPECT_FALSE(s.parameters[2].relative());
  EXPECT_DOUBLE_EQ(s.mse, 0.75 / 3.0);
  EXPECT_DOUBLE_EQ(s.mse_varied_only, 0.75 / 2.0);
  EXPECT_DOUBLE_EQ(s.baseline_mse, 6.0 / 3.0);
  EXPECT_DOUBLE_EQ(s.baseline_mse_varied_only, 3.0);
  EXPECT_DOUBLE_EQ(s.ratio, 0.125);
  EXPECT_DOUBLE_EQ(*s.H_ratio, 0.1);
  EXPECT_DOUBLE_EQ(s.median_row, (1.25 / 3 + 0.25 / 3) / 2);
  EXPECT_DOUBLE_EQ(s.worst_row, 1.25 / 3);
  EXPECT_DOUBLE_EQ(s.failed_rows, 0.0);
  const std::vector<double> constant = {5.0, 2.0, 0.3, 4.0, 1.0, 0.3};  // the first row is the training mean
  EXPECT_DOUBLE_EQ(
      score({constant, truth, mean, {"H", "D", "X"}, {"s", "pu", "pu"}, {1.0, 0.0, 0.3}, {10.0, 3.0, 0.3}})
          .failed_rows,
      0.5);
}

TEST(Metrics, OmitHWhenAbsent) {
  const std::vector<double> v = {1.0, 2.0}, mean = {0.0};
  EXPECT_FALSE(score({v, v, mean, {"K"}, {"pu"}, {0.0}, {3.0}}).H_ratio);
}

TEST(Experiment, FilesOfTheRepositoryAreValid) {
  const std::filesystem::path folder = SWINGBANK_SOURCE "/configs/experiments";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".toml") continue;
    const Experiment e = read_experiment(entry.path());
    for (const char* preset : {"quick", "nightly", "thesis"}) {
      EXPECT_GT(std::stoul(e.print(preset, "draws")), 0u);
      EXPECT_FALSE(e.preset(preset).networks.empty());
    }
    EXPECT_FALSE(e.print("quick", "tasks").empty());
    ++files;
  }
  EXPECT_EQ(files, 6);  // Tables IV, V and VI; across grids
}

TEST(Experiment, IsNamedAfterItsFile_WithoutAThesisTable) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("experiment-test-{}", ::getpid());
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "data.toml") << "draws = 1\n";
  std::ofstream(folder / "mine.toml") << "title = \"mine\"\n"
                                         "dataset = \"data.toml\"\n"
                                         "split = \"by-databank-point\"\n"
                                         "[preset.quick]\n"
                                         "draws = 60\n"
                                         "networks = [\"cnn\"]\n"
                                         "noise = [0.0, 0.005]\n"
                                         "channels = [\"P\"]\n"
                                         "start_s = 2.0\n"
                                         "end_s = 6.0\n"
                                         "slice = 1\n"
                                         "form = \"both\"\n"
                                         "pca_components = 4\n"
                                         "epochs = 1\n"
                                         "batch = 64\n"
                                         "learning_rate = 1e-3\n"
                                         "schedule = \"cosine\"\n"
                                         "patience = 1\n"
                                         "validation_share = 0.1\n";
  const Experiment e = read_experiment(folder / "mine.toml");
  EXPECT_EQ(e.table, "mine");
  EXPECT_EQ(e.print("quick", "table"), "mine");
  std::filesystem::remove_all(folder);
}

TEST(Experiment, NetworkTableSetsInputAndTraining) {
  const auto file = std::filesystem::path(SWINGBANK_SOURCE) / "configs/experiments/ieee39_genrou.toml";
  const Experiment e = read_experiment(file);
  EXPECT_EQ(e.input("quick", "cnn").recipe.form, data::InputForm::both);
  EXPECT_EQ(e.input("quick", "mlp").recipe.form, data::InputForm::physics);
  EXPECT_EQ(e.input("quick", "mlp").pca_components, 48u);
  EXPECT_EQ(e.training("quick", "cnn").weight_decay, 0.0);
  EXPECT_EQ(e.training("quick", "mlp").clip, 1.0);
  EXPECT_EQ(e.training("quick", "mlp-corrects").kind, "mlp");
  EXPECT_EQ(e.training("quick", "mlp-corrects").corrects, "closed-form");
  EXPECT_THROW((void)e.input("quick", "absent"), InputError);
}

TEST(Experiment, ReportsEveryProblemWithItsLine) {
  const auto file = std::filesystem::temp_directory_path() / "swingbank-experiment-test.toml";
  std::ofstream(file)
      << "table = \"IX\"\ntitle = 5\ndataset = \"absent.toml\"\nsplit = \"by-databank-point\"\n"
         "[preset.quick]\ndraws = 0\nnetworks = [\"cnm\"]\nepoch = 3\n";
  try {
    (void)read_experiment(file);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    const std::string text = e.what();
    for (const char* part : {":1:", ":2:", ":6:", "cnm", "epoch", "absent.toml"})
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace swingbank::train::loop
