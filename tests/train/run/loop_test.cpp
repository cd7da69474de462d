// Training on a synthetic dataset: it learns from true labels and not from shuffled ones, and a resumed run
// equals an uninterrupted one.
#include "train/loop/loop.hpp"

#include <fstream>
#include <memory>
#include <stdexcept>

#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/run_lock.hpp"
#include "tests/train/data/fixture.hpp"
#include "train/run/cross_validate.hpp"
#include "train/run/detail/result.hpp"

namespace swingbank::train::run {
namespace {
using namespace test;
using nlohmann::json;

struct World {
  test::Folder folder;
  mpi::store::Dataset dataset;
  data::ShardStream stream;
  explicit World(const std::string& name, std::size_t rows = 300, std::size_t samples = 16)
      : folder(name),
        dataset(test::make_dataset(folder.path / "data", plan(rows, samples))),
        stream(dataset, test::whole_record(plan(rows, samples))) {}
  static test::Plan plan(std::size_t rows, std::size_t samples) {
    test::Plan p;
    p.rows = rows;
    p.rows_per_shard = rows / 2 + 1;
    p.samples = samples;
    p.rate = 8.0;
    return p;
  }
};

loop::TrainingRecipe recipe(std::size_t epochs) { return {epochs, 32, 1e-3, "cosine", 100, 0.1}; }

/// Experiment with one preset and network, without a file.
RunRequest request(const World& world, const std::string& network, std::size_t epochs) {
  RunRequest r;
  r.experiment.table = "V";
  r.experiment.split = loop::Split::leave_one_out;
  for (int g = 30; g < 40; ++g) r.experiment.folds.push_back(g);
  loop::Preset p;
  p.name = "quick";
  p.networks = {network};
  p.input[network] = {test::whole_record(World::plan(world.dataset.rows, world.dataset.samples))};
  p.training[network] = recipe(epochs);
  p.training[network].kind = network;
  r.experiment.presets["quick"] = p;
  r.preset = "quick";
  r.network = network;
  r.generator = 33;
  r.out = world.folder.path / "out";
  r.runtime = {1, "test"};
  r.quiet = true;
  return r;
}

json result_of(const RunRequest& r) {
  std::ifstream in(r.out / (run_name(r) + ".json"));
  return json::parse(in);
}

/// Rows of a World's dataset without those of generator 33, as input of train_network.
struct Prepared {
  explicit Prepared(const World& world)
      : split(data::leave_one_out(world.stream.labels(), {33, 0.1, 1})),
        targets(scaled_targets(world.stream.labels(),
                               data::TargetScale::fit(world.stream.labels().values, 3, split.train), split,
                               false, 1)),
        features(data::Features::fit(world.stream, split.train, 0)),
        data{world.stream, features, split.train, split.validation, targets} {}
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;
  data::RowSplit split;
  std::vector<float> targets;
  data::Features features;
  loop::LoopData data;  // declared last, because it refers to the members above
};

void expect_resumed_run_equals_unbroken(const std::string& name) {
  const World world("resume", 150);
  const Prepared p(world);
  const networks::NetworkShape shape{2, 16, 3, {2.0f, 2.0f, 1.0f}};
  const json run = {{"test", 1}};
  const auto train = [&](const std::string& checkpoint, const std::vector<int>& stops,
                         loop::LoopReport& report) {
    std::vector<float> out;
    for (std::size_t part = 0; part <= stops.size(); ++part) {
      loop::seed_torch(9);
      const auto network = networks::make_network(name, shape);
      int batches = 0;
      loop::LoopSettings settings;
      settings.recipe = recipe(4);
      settings.checkpoint = world.folder.path / checkpoint;
      settings.run = &run;
      if (part < stops.size()) settings.stop = [&] { return batches++ == stops[part]; };
      loop::TrainingProgress progress("test", 1, true);
      report = loop::train_network(*network, p.data, settings, progress);
      EXPECT_EQ(report.finished, part == stops.size());
      out = loop::predict(*network, world.stream, p.features, p.split.test);
    }
    return out;
  };
  loop::LoopReport whole, broken;
  const auto expected = train(name + "-a", {}, whole);
  const auto got =
      train(name + "-b", {8, 3}, broken);  // 4 batches per epoch: stops after 2 epochs, then within an epoch
  EXPECT_EQ(got, expected) << name;
  EXPECT_EQ(broken.epochs, 4u);
  EXPECT_EQ(broken.best_epoch, whole.best_epoch);
  EXPECT_EQ(broken.validation, whole.validation);
  ASSERT_EQ(broken.curve.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(broken.curve[k].epoch, k + 1);
    EXPECT_EQ(broken.curve[k].training, whole.curve[k].training);
    EXPECT_EQ(broken.curve[k].validation, whole.curve[k].validation);
    EXPECT_EQ(broken.curve[k].learning_rate, whole.curve[k].learning_rate);
  }
  EXPECT_EQ(broken.curve[broken.best_epoch - 1].validation, broken.validation);
}
TEST(Training, ResumedRunEqualsAnUnbrokenOneBitForBit) { expect_resumed_run_equals_unbroken("cnn"); }
TEST(TrainingFull, ResumedRunEqualsAnUnbrokenOneBitForBit_WithRecurrentNetwork) {
  expect_resumed_run_equals_unbroken("gru");
}

TEST(Training, ReadsNewRowsInEachEpochAfterTheFirst) {
  const World world("old_rows", 150), other("new_rows", 200);
  const Prepared p(world), of_other(other);
  const networks::NetworkShape shape{2, 16, 3, {2.0f, 2.0f, 1.0f}};
  const json run = {{"test", 1}};
  std::vector<std::size_t> asked;
  bool stop = false;
  const auto train = [&](const std::string& checkpoint, bool fresh) {
    loop::seed_torch(9);
    const auto network = networks::make_network("cnn", shape);
    loop::LoopSettings settings;
    settings.recipe = recipe(4);
    settings.checkpoint = world.folder.path / checkpoint;
    settings.run = &run;
    loop::LoopData data = p.data;
    if (fresh)
      data.fresh = [&](std::size_t epoch) -> std::optional<loop::EpochRows> {
        asked.push_back(epoch);
        if (stop && epoch == 2) return std::nullopt;
        const auto first = of_other.split.train.begin() + static_cast<std::ptrdiff_t>(epoch);
        return loop::EpochRows{{std::shared_ptr<const void>(), &other.stream},
                               {first, of_other.split.train.end()},
                               of_other.targets};
      };
    loop::TrainingProgress progress("test", 1, true);
    const loop::LoopReport report = loop::train_network(*network, data, settings, progress);
    EXPECT_EQ(report.finished, !stop);
    return loop::predict(*network, world.stream, p.features, p.split.test);
  };
  const auto old = train("old", false), expected = train("new", true);
  EXPECT_NE(old, expected);
  EXPECT_EQ(asked, (std::vector<std::size_t>{1, 2, 3}));
  stop = true;
  train("stopped", true);
  stop = false;
  asked.clear();
  EXPECT_EQ(train("stopped", true), expected);
  EXPECT_EQ(asked, (std::vector<std::size_t>{2, 3}));
}

TEST(Training, KillLosesAtMostTheCurrentEpoch) {
  const World world("killed", 150);
  const Prepared p(world);
  const json run = {{"test", 1}};
  constexpr int kBatches = 4;  // per epoch
  // Number of batches begun until the end, or until the process is killed.
  const auto batches = [&](int dies_at) {
    const auto network = networks::make_network("cnn", {2, 16, 3, {2.0f, 2.0f, 1.0f}});
    int begun = 0;
    loop::LoopSettings settings;
    settings.recipe = recipe(3);
    settings.checkpoint = world.folder.path / "run.checkpoint";
    settings.checkpoint_after_epoch_s = 0.0;
    settings.run = &run;
    settings.stop = [&] {
      if (begun == dies_at) throw std::runtime_error("killed");
      ++begun;
      return false;
    };
    loop::TrainingProgress progress("test", 1, true);
    try {
      loop::train_network(*network, p.data, settings, progress);
    } catch (const std::runtime_error&) {
      EXPECT_EQ(begun, dies_at);
    }
    return begun;
  };
  EXPECT_EQ(batches(kBatches + 2), kBatches + 2);
  EXPECT_EQ(batches(-1), 2 * kBatches);
}

TEST(Training, RefusesADamagedOrForeignCheckpoint) {
  const World world("damaged");
  const Prepared p(world);
  const auto file = world.folder.path / "run.checkpoint";
  const json run = {{"test", 1}}, other = {{"test", 2}};
  const auto train = [&](const json& identity, int stop_after) {
    loop::seed_torch(9);
    const auto network = networks::make_network("cnn", {2, 16, 3, {2.0f, 2.0f, 1.0f}});
    loop::LoopSettings settings;
    settings.recipe = recipe(1);
    settings.checkpoint = file;
    settings.run = &identity;
    int batches = 0;
    settings.stop = [&] { return batches++ == stop_after; };
    loop::TrainingProgress progress("test", 1, true);
    return loop::train_network(*network, p.data, settings, progress).finished;
  };
  ASSERT_FALSE(train(run, 2));
  EXPECT_THROW((void)train(other, 2), InputError);
  {
    std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
    bytes.seekp(5000);
    bytes.put('\x7f');
    bytes.put('\x01');
  }
  EXPECT_THROW((void)train(run, 2), InputError);
  std::filesystem::resize_file(file, 6000);
  EXPECT_THROW((void)train(run, 2), InputError);
}

TEST(Training, LearnsFromTrueLabelsOnly) {
  const World world("learn", 800);
  RunRequest r = request(world, "cnn", 4);
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  const json learnt = result_of(r);
  EXPECT_LT(learnt["ratio"], 0.5);
  EXPECT_LT(learnt["H_ratio"], 0.5);
  EXPECT_EQ(learnt["generator"], 33);
  EXPECT_EQ(learnt["test_rows"], 80);
  EXPECT_EQ(learnt["train_rows"].get<int>() + learnt["validation_rows"].get<int>(), 720);
  // The constant third parameter is learnt exactly and lowers the mean over all three parameters.
  EXPECT_NEAR(learnt["mse_varied_only"].get<double>() / learnt["mse"].get<double>(), 1.5, 1e-3);
  EXPECT_TRUE(learnt["per_parameter"][2]["relative"].is_null());
  EXPECT_EQ(run(world.stream, r), RunOutcome::already_done);
  EXPECT_TRUE(std::filesystem::is_empty(r.out / "checkpoints"));

  r.shuffle_labels = true;
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  const json shuffled = result_of(r);
  // Only training labels are shuffled, so the labels of test rows are unpredictable. The ratio scatters by
  // some per cent for 80 rows, and slight overfitting raises it further.
  EXPECT_GT(shuffled["ratio"], 0.9);
  EXPECT_LT(shuffled["ratio"], 1.25);
}

TEST(Training, NoiseIsNamedInRunResultAndFeatures) {
  const World world("noisy");
  const data::ShardStream noisy(world.dataset, test::whole_record(World::plan(300, 16)),
                                {.noise = {0.001, 1}});
  RunRequest r = request(world, "cnn", 1);
  EXPECT_EQ(run_name(r).find("noise"), std::string::npos);
  r.noise = 0.001;
  r.test_rows = 15;
  EXPECT_NE(run_name(r).find("-noise0.001-"), std::string::npos);
  ASSERT_EQ(run(noisy, r), RunOutcome::done);
  const json result = result_of(r);
  EXPECT_EQ(result["noise"], 0.001);
  EXPECT_EQ(result["run"]["noise"], 0.001);
  EXPECT_EQ(result["test_rows"], 15);
}

TEST(Training, FractionOfTheRowsTrainsAndTheTestRowsStayTheSame) {
  const World world("share", 400);
  RunRequest r = request(world, "cnn", 1);
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  const json whole = result_of(r);
  r.train_share = 0.25;
  EXPECT_NE(run_name(r).find("-share0.25-"), std::string::npos);
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  const json part = result_of(r);
  EXPECT_EQ(whole["train_share"], 1.0);
  EXPECT_EQ(part["train_share"], 0.25);
  EXPECT_NEAR(part["train_rows"].get<double>(), whole["train_rows"].get<double>() / 4, 0.5);
  EXPECT_EQ(part["test_rows"], whole["test_rows"]);
}

TEST(Training, DistinguishesResultsOfOtherVersions) {
  const World world("maker");
  RunRequest r = request(world, "cnn", 1);
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  json result = result_of(r);
  EXPECT_EQ(result["software"], result["run"]["software"]);
  EXPECT_NE(result["software"].get<std::string>().find(", code "), std::string::npos);
  const auto write = [&](const char* key) {
    json changed = result;
    changed["run"][key] = "another";
    std::ofstream(r.out / (run_name(r) + ".json")) << changed.dump();
  };
  write("kernels");
  EXPECT_EQ(run(world.stream, r),
            RunOutcome::already_done);  // a finished result may come from another processor
  write("software");
  try {
    (void)run(world.stream, r);
    FAIL() << "taken as done";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("it differs from this run's in: software"), std::string::npos)
        << e.what();
  }
  r.any_maker = true;
  EXPECT_EQ(run(world.stream, r), RunOutcome::already_done);
}

TEST(Training, ASecondProcessAtTheSameRunIsRefused) {
  const World world("second");
  RunRequest r = request(world, "cnn", 1);
  r.patience = std::chrono::milliseconds(200);
  make_folder(r.out / "checkpoints");
  const auto file = r.out / "checkpoints" / (run_name(r) + ".lock");
  {
    const RunLock other(file, {"", "", ""});
    try {
      run(world.stream, r);
      FAIL() << "went on";
    } catch (const InputError& e) {
      const std::string sentence = e.what();
      EXPECT_NE(sentence.find("result file in use at " + (r.out / (run_name(r) + ".json")).string()),
                std::string::npos)
          << sentence;
    }
  }
  EXPECT_EQ(run(world.stream, r), RunOutcome::done);
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(TrainingFull, RecurrentNetworksLearn) {
  const World world("recurrent", 500, 8);
  for (const std::string name : {"lstm", "gru"}) {
    RunRequest r = request(world, name, 3);
    ASSERT_EQ(run(world.stream, r), RunOutcome::done);
    EXPECT_LT(result_of(r)["H_ratio"], 0.7) << name;
  }
}

TEST(Training, LeftOutGeneratorDoesNotAffectTheWeights) {
  // The same run on two data sets that differ in the left-out generator's records only.
  const World world("trace");
  test::Folder folder("moved");
  test::Plan moved = World::plan(300, 16);
  moved.shift_generator = 33;
  const data::ShardStream other(test::make_dataset(folder.path, moved), test::whole_record(moved));
  const auto outputs = [&](const data::ShardStream& stream, int generator) {
    const data::RowSplit split = data::leave_one_out(stream.labels(), {generator, 0.1, 1});
    const data::TargetScale scale = data::TargetScale::fit(stream.labels().values, 3, split.train);
    const auto targets = scaled_targets(stream.labels(), scale, split, false, 1);
    const data::Features features = data::Features::fit(stream, split.train, 0);
    loop::seed_torch(9);
    const auto network = networks::make_network("cnn", {2, 16, 3, {2.0f, 2.0f, 1.0f}});
    loop::LoopSettings settings;
    settings.recipe = recipe(2);
    loop::TrainingProgress progress("test", 1, true);
    (void)loop::train_network(*network, {stream, features, split.train, split.validation, targets}, settings,
                              progress);
    return loop::predict(*network, stream, features, split.train);
  };
  EXPECT_EQ(outputs(world.stream, 33), outputs(other, 33));
  EXPECT_NE(outputs(world.stream, 34),
            outputs(other, 34));  // with the generator in training, the outputs differ
}

TEST(Training, RefusesAResultOfOtherData) {
  const World world("foreign");
  RunRequest r = request(world, "cnn", 1);
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  r.experiment.presets["quick"].training["cnn"].batch = 16;
  EXPECT_THROW((void)run(world.stream, r), InputError);
}

TEST(Training, ReportsWhereItDiverged) {
  const World world("diverge");
  RunRequest r = request(world, "cnn", 3);
  r.experiment.presets["quick"].training["cnn"].learning_rate = 1e30;
  try {
    (void)run(world.stream, r);
    FAIL() << "a rate of 1e30 trained";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("lower learning_rate"), std::string::npos) << e.what();
  }
}

TEST(CrossValidate, ProcessesShareTheFolds) {
  const std::vector<std::int32_t> folds = {30, 31, 32, 33, 34};
  EXPECT_EQ(share_of(folds, {0, 2}), (std::vector<std::int32_t>{30, 32, 34}));
  EXPECT_EQ(share_of(folds, {1, 2}), (std::vector<std::int32_t>{31, 33}));
  EXPECT_EQ(share_of(folds, {0, 1}), folds);
  EXPECT_TRUE(share_of(folds, {5, 6}).empty());
}

TEST(LearningRate, FallsAlongACosineAfterAWarmUp) {
  const loop::TrainingRecipe constant{10, 32, 1e-3, "constant", 5, 0.1},
      cosine{10, 32, 1e-3, "cosine", 5, 0.1};
  EXPECT_EQ(loop::learning_rate(constant, 999, 1000), 1e-3);
  EXPECT_LT(loop::learning_rate(cosine, 0, 1000), 1e-4);
  EXPECT_NEAR(loop::learning_rate(cosine, 500, 1000), 0.505e-3, 1e-6);
  EXPECT_NEAR(loop::learning_rate(cosine, 999, 1000), 1e-5, 1e-7);
}

}  // namespace
}  // namespace swingbank::train::run
