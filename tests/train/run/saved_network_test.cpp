// A saved network returns the output of the trained one.
#include "train/run/saved_network.hpp"

#include <fstream>

#include "base/json.hpp"
#include "base/problem.hpp"
#include "tests/train/data/fixture.hpp"
#include "train/loop/loop.hpp"
#include "train/run/detail/result.hpp"

namespace swingbank::train::run {
namespace {
using namespace test;
using nlohmann::json;

struct SavedWorld {
  test::Folder folder;
  test::Plan plan;
  mpi::store::Dataset dataset;
  data::ShardStream stream;
  explicit SavedWorld(const std::string& name, data::InputForm form = data::InputForm::relative)
      : folder(name),
        plan(small(form == data::InputForm::physics)),
        dataset(test::make_dataset(folder.path / "data", plan)),
        stream(dataset, input(plan, form)) {}
  static test::Plan small(bool electrical) {
    test::Plan p;
    p.electrical = electrical;
    p.rows = 300;
    p.samples = 32;
    p.rate = 16.0;
    return p;
  }
  static data::InputRecipe input(const test::Plan& plan, data::InputForm form) {
    data::InputRecipe r = test::whole_record(plan);
    r.channels = {"speed", "P"};  // not in the order of the records
    r.slice = form == data::InputForm::physics ? 1 : 2;
    if (form == data::InputForm::physics) r.channels = {"speed", "V", "Q", "P"};
    r.form = form;
    return r;
  }
  RunRequest request(const std::string& network, std::size_t pca = 0) const {
    RunRequest r;
    r.experiment.table = "V";
    loop::Preset p;
    p.name = "quick";
    p.networks = {network};
    p.input[network] = {input(plan, stream.selection().form), pca};
    p.training[network] = {2, 32, 1e-3, "cosine", 100, 0.1};
    p.training[network].kind = network;
    r.experiment.presets["quick"] = p;
    r.preset = "quick";
    r.network = network;
    r.generator = 33;
    r.out = folder.path / "out";
    r.runtime = {1, "test"};
    r.quiet = true;
    return r;
  }
};

/// Row of the dataset as input of an estimate: channels speed, P.
std::vector<float> record_of(const SavedWorld& world, std::uint64_t row, std::size_t samples) {
  const mpi::store::ShardInfo& shard = world.dataset.shards[row / world.plan.rows_per_shard];
  mpi::store::RowBlock block;
  mpi::store::read_rows(shard, row - shard.first_row, 1, block);
  std::vector<float> out;
  const bool all = world.plan.electrical;
  for (const std::size_t channel :
       all ? std::vector<std::size_t>{1, 3, 2, 0} : std::vector<std::size_t>{1, 0})
    out.insert(out.end(), block.records.begin() + static_cast<std::ptrdiff_t>(channel * block.samples),
               block.records.begin() + static_cast<std::ptrdiff_t>(channel * block.samples + samples));
  return out;
}

json saved_result_of(const RunRequest& r) {
  std::ifstream in(r.out / (run_name(r) + ".json"));
  return json::parse(in);
}

TEST(SavedNetwork, EqualsTheTrainedNetwork) {
  for (const auto& [network, pca] :
       {std::pair{"cnn", std::size_t{0}}, {"cnn", std::size_t{5}}, {"gru", std::size_t{0}}}) {
    const SavedWorld world(std::string("saved-") + network + std::to_string(pca), data::InputForm::both);
    const RunRequest r = world.request(network, pca);
    ASSERT_EQ(run(world.stream, r), RunOutcome::done);
    const SavedNetwork saved = SavedNetwork::load(r.out);
    const NetworkInfo& info = saved.info();
    EXPECT_EQ(info.channels, (std::vector<std::string>{"speed", "P"}));
    EXPECT_EQ(info.left_out, 33);
    EXPECT_EQ(info.rate, 16.0);
    EXPECT_FALSE(info.fault_start);  // absent in synthetic data
    // The errors in the training's result equal those of the saved network, which estimates row by row.
    const data::RowSplit split = data::leave_one_out(world.stream.labels(), {33, 0.1, 1});
    std::vector<double> square(3, 0.0);
    for (const std::uint64_t row : split.test) {
      const Estimate e = saved.estimate(record_of(world, row, info.samples));
      EXPECT_GT(e.input_rms, 0.1);
      for (std::size_t p = 0; p < 3; ++p) {
        const double error = e.values[p] - world.stream.labels().values[row * 3 + p];
        square[p] += error * error / static_cast<double>(split.test.size());
      }
    }
    const json result = saved_result_of(r);
    for (std::size_t p = 0; p < 3; ++p)
      // One row at a time instead of a batch: single-precision sums in another order.
      EXPECT_NEAR(square[p], result["per_parameter"][p]["mse"].get<double>(), 1e-4 * square[p] + 1e-9)
          << network;
  }
}

TEST(SavedNetwork, EqualsTheTrainedNetworkOnPhysicalChannels) {
  const SavedWorld world("saved-physics", data::InputForm::physics);
  RunRequest r = world.request("mlp", 6);
  auto& recipe = r.experiment.presets["quick"].training["mlp"];
  recipe.loss_power = 0.5;
  recipe.weight_decay = 0.01;
  recipe.clip = 1.0;
  recipe.average = 0.9;
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  const SavedNetwork saved = SavedNetwork::load(r.out);
  EXPECT_EQ(saved.info().fault_start, 0.5);
  const json result = saved_result_of(r);
  EXPECT_LT(result["ratio"].get<double>(), 0.9);
  const data::RowSplit split = data::leave_one_out(world.stream.labels(), {33, 0.1, 1});
  double square = 0.0;
  for (const std::uint64_t row : split.test) {
    const double error = saved.estimate(record_of(world, row, saved.info().samples)).values[0] -
                         world.stream.labels().values[row * 3];
    square += error * error / static_cast<double>(split.test.size());
  }
  EXPECT_NEAR(square, result["per_parameter"][0]["mse"].get<double>(), 1e-3 * square);
}

/// Synthetic data, and a training run in which each training row draws its noise level.
struct NoisyRuns {
  SavedWorld world;
  RunRequest request;
  explicit NoisyRuns(const std::string& name)
      : world(name, data::InputForm::physics), request(world.request("mlp", 6)) {
    loop::Preset& p = request.experiment.presets["quick"];
    p.input["mlp"].recipe.shows_level = true;
    p.training["mlp"].noise_levels = data::NoiseLevels{1e-4, 5e-3, 0.25};
    p.training["mlp"].posterior_epochs = 2;
    p.training["mlp"].set_aside = 2;
  }
  [[nodiscard]] data::ShardStream stream(double noise) const {
    const loop::Preset& p = request.experiment.presets.at("quick");
    return {
        world.dataset, p.input.at("mlp").recipe, {.noise = {noise, 1, p.training.at("mlp").noise_levels}}};
  }
};

TEST(SavedNetwork, OneNetworkServesAllNoiseLevelsWithItsPosterior) {
  NoisyRuns w("saved-levels");
  ASSERT_EQ(run(w.stream(0.0), w.request), RunOutcome::done);
  const auto file = w.request.out / "V-mlp-quick-seed1-gen33.network";
  const auto trained = std::filesystem::last_write_time(file);
  const json without = saved_result_of(w.request);
  w.request.noise = 0.005;
  ASSERT_EQ(run(w.stream(0.005), w.request), RunOutcome::done);
  EXPECT_EQ(std::filesystem::last_write_time(file), trained);
  const json with = saved_result_of(w.request);
  EXPECT_EQ(with["noise"], 0.005);
  EXPECT_EQ(with["best_epoch"], without["best_epoch"]);
  EXPECT_NE(with["mse"], without["mse"]);
  const json& believed = with["posterior"];
  EXPECT_EQ(believed["set_aside"].size(), 2u);
  EXPECT_EQ(believed["test"]["rows"], 30);
  EXPECT_EQ(believed["test"]["per_parameter"].size(), 2u);  // the third parameter is constant
  EXPECT_GT(believed["test"]["coverage_90"].get<double>(), 0.5);
  EXPECT_LT(believed["test"]["coverage_50"].get<double>(), believed["test"]["coverage_90"].get<double>());

  // the saved network has the posterior that was tested
  const SavedNetwork saved = SavedNetwork::load(file);
  EXPECT_TRUE(saved.info().noise_as_input);
  const data::ShardStream stream = w.stream(0.0);
  const data::RowSplit split = data::leave_one_out(
      stream.labels(), {.generator = 33, .validation_share = 0.1, .seed = 1, .set_aside = 2});
  double covered = 0.0, width = 0.0;
  for (const std::uint64_t row : split.test) {
    const Estimate e = saved.estimate(record_of(w.world, row, saved.info().samples), 0.0);
    ASSERT_TRUE(e.intervals[0]);
    EXPECT_FALSE(e.intervals[2]);
    const double H = stream.labels().values[row * 3];
    covered += H > e.intervals[0]->low && H < e.intervals[0]->high ? 1.0 / 30 : 0.0;
    width += (e.intervals[0]->high - e.intervals[0]->low) / 30;
  }
  const json& of_H = without["posterior"]["test"]["per_parameter"][0];
  EXPECT_NEAR(covered, of_H["coverage_90"].get<double>(), 1e-6);
  EXPECT_NEAR(width, of_H["width_90"].get<double>(), 1e-3 * width);
}

TEST(SavedNetwork, NoiseOfEveryEpochSurvivesAnInterruption) {
  NoisyRuns whole("levels-whole"), broken("levels-broken");
  ASSERT_EQ(run(whole.stream(0.001), whole.request), RunOutcome::done);
  // stopped by a signal in the epochs of the network, and again in those of the posterior
  const data::ShardStream stream = broken.stream(0.001);
  std::size_t asked = 0;
  for (const std::size_t stop : {std::size_t{9}, std::size_t{13}}) {
    broken.request.stop = [&asked, stop] { return asked++ == stop; };
    asked = 0;
    ASSERT_EQ(run(stream, broken.request), RunOutcome::stopped) << stop;
  }
  broken.request.stop = {};
  ASSERT_EQ(run(stream, broken.request), RunOutcome::done);
  const json a = saved_result_of(whole.request), b = saved_result_of(broken.request);
  EXPECT_EQ(a["mse"], b["mse"]);
  EXPECT_EQ(a["posterior"], b["posterior"]);
  EXPECT_EQ(a["validation_mse"], b["validation_mse"]);
}

TEST(SavedNetwork, ErrorsAreThoseOnTheLeftOutGenerator) {
  const SavedWorld world("spread");
  const RunRequest r = world.request("cnn");
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  const SavedNetwork saved = SavedNetwork::load(r.out / (run_name(r) + ".network"));
  const data::RowSplit split = data::leave_one_out(world.stream.labels(), {33, 0.1, 1});
  double sum = 0.0, square = 0.0, largest = 0.0;
  for (const std::uint64_t row : split.validation)
    largest = std::max(largest, saved.estimate(record_of(world, row, saved.info().samples)).input_rms);
  for (const std::uint64_t row : split.test) {
    const Estimate e = saved.estimate(record_of(world, row, saved.info().samples));
    const double error = e.values[0] - world.stream.labels().values[row * 3];
    sum += error;
    square += error * error;
  }
  const auto n = static_cast<double>(split.test.size());
  const EstimatedParameter& h = saved.info().parameters.at(0);
  EXPECT_EQ(h.name, "H");
  EXPECT_EQ(h.unit, "s");
  EXPECT_EQ(h.effect, "TEST");
  // One row at a time instead of a batch: single-precision sums in another order.
  EXPECT_NEAR(h.bias, sum / n, 1e-4);
  EXPECT_NEAR(h.rms_error, std::sqrt(square / n), 1e-4);
  EXPECT_NEAR(saved.info().input_rms_seen, largest, 1e-5);
  EXPECT_GT(h.rms_error, 0.01);
}

TEST(SavedNetwork, RefusesOtherFiles) {
  const SavedWorld world("none");
  RunRequest r = world.request("cnn");
  const auto refusal = [](const std::filesystem::path& path) {
    try {
      (void)SavedNetwork::load(path);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("nothing thrown");
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != text.npos;
  };
  r.save_network = false;
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  EXPECT_TRUE(has(refusal(r.out), "contains no .network file"));
  EXPECT_TRUE(has(refusal(r.out / "x.network"), "there is no such file"));
  r.save_network = true;
  r.seed = 2;
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  const auto file = r.out / (run_name(r) + ".network");
  std::filesystem::copy(file, r.out / "other.network");
  EXPECT_TRUE(has(refusal(r.out), "2 network files"));
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekp(-5000, std::ios::end);
  bytes.put('\x7f');
  bytes.put('\x01');
  bytes.close();
  EXPECT_TRUE(has(refusal(file), "its checksum is wrong"));
  std::filesystem::resize_file(file, 6000);
  EXPECT_TRUE(has(refusal(file), "network file cannot be used"));
}

/// Flips one bit of every byte of the header, and of every thousandth byte after it, one at a time.
TEST(SavedNetworkFull, DetectsFlippedBytes) {
  const SavedWorld world("flipped");
  RunRequest r = world.request("gru");
  r.save_network = true;
  ASSERT_EQ(run(world.stream, r), RunOutcome::done);
  const auto file = r.out / (run_name(r) + ".network");
  EXPECT_NO_THROW((void)SavedNetwork::load(file));
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  const auto length = static_cast<std::streamoff>(std::filesystem::file_size(file));
  constexpr std::streamoff kHeader = 4000;
  int flipped = 0;
  for (std::streamoff i = 0; i < length; i += i < kHeader ? 1 : 1009, ++flipped) {
    bytes.seekg(i);
    const auto was = static_cast<unsigned char>(bytes.get());
    const auto put = [&](unsigned c) {
      bytes.seekp(i);
      bytes.put(static_cast<char>(c));
      bytes.flush();
    };
    put(was ^ (1U << i % 8));
    EXPECT_THROW((void)SavedNetwork::load(file), InputError) << "byte " << i << " of " << length;
    put(was);
  }
  EXPECT_NO_THROW((void)SavedNetwork::load(file));
  RecordProperty("flipped", flipped);
}

TEST(TargetScale, ShiftsANegativeRangeToZero) {
  const std::vector<double> values = {-4, 1, -2, 2, -3, 3};
  const std::vector<std::uint64_t> rows = {0, 1, 2};
  const std::vector<double> low = {-5, 0.5};
  const data::TargetScale scale = data::TargetScale::fit(values, 2, rows, low);
  EXPECT_EQ(scale.origin, (std::vector<double>{-5, 0}));
  EXPECT_GT(scale.scaled(-4.9, 0), 0.0);                          // representable by a ReLU
  EXPECT_NEAR(scale.raw(scale.scaled(-3.7, 0), 0), -3.7, 1e-15);  // equal up to rounding
  EXPECT_EQ(scale.scaled(2.0, 1), 2.0 / scale.unit[1]);
}

}  // namespace
}  // namespace swingbank::train::run
