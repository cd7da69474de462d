// Stream, split, PCA and normalisation.
#include <algorithm>
#include <functional>
#include <numeric>
#include <set>

#include "base/problem.hpp"
#include "tests/train/data/fixture.hpp"
#include "train/data/features.hpp"
#include "train/data/split.hpp"

namespace swingbank::train::data {
namespace {
using namespace test;

TEST(Downsample, TakesChannelsWindowAndEveryNthSample) {
  mpi::store::DatasetHeader header;
  header.rate = 10.0;
  header.samples = 20;
  header.channel_names = {"P", "Q"};
  const auto s = select_input({{"Q"}, 0.5, 1.5, 4, InputForm::deviation}, header);
  std::vector<float> record(40);
  std::iota(record.begin(), record.end(), 100.0f);
  std::vector<float> out(s.values());
  s.apply(record.data(), 20, 0, 0, out.data());
  EXPECT_EQ(out, (std::vector<float>{5.0f, 9.0f, 13.0f}));  // samples 5, 9, 13 of Q, minus its sample 0
  EXPECT_DOUBLE_EQ(s.rate, 2.5);
}

TEST(Downsample, RelativeFormIsIndependentOfTheAmplitude) {
  mpi::store::DatasetHeader header;
  header.rate = 1.0;
  header.samples = 4;
  header.channel_names = {"P", "Q"};
  const std::vector<float> small = {1.0f, 2.0f, 0.0f, 1.0f, 5.0f, 8.0f, 2.0f, 5.0f},
                           large = {1.0f, 5.0f, -3.0f, 1.0f, 5.0f, 17.0f, -7.0f, 5.0f};
  const auto show = [&](const std::vector<float>& record, InputForm form) {
    const auto s = select_input({{"P", "Q"}, 0.0, 4.0, 1, form}, header);
    std::vector<float> out(s.values());
    s.apply(record.data(), 4, 0, 0, out.data());
    return out;
  };
  const float r = std::sqrt(2.0f);  // root mean square of 0, 1, -1, 0 is 1 / sqrt 2
  const std::vector<float> relative = {0.0f, r, -r, 0.0f, 0.0f, 3.0f * r, -3.0f * r, 0.0f};
  for (const auto& record : {small, large}) {
    const auto shown = show(record, InputForm::relative);
    ASSERT_EQ(shown.size(), relative.size());
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(shown[i], relative[i], 1e-6);  // single precision
  }
  auto both = show(small, InputForm::both);
  ASSERT_EQ(both.size(), 16u);
  EXPECT_TRUE(std::equal(small.begin(), small.end(), both.begin()));
  EXPECT_NEAR(both[13], 3.0f * r, 1e-6);
}

TEST(Downsample, ReportsAllProblemsAtOnce) {
  mpi::store::DatasetHeader header;
  header.rate = 10.0;
  header.samples = 20;
  header.channel_names = {"P", "Q"};
  try {
    (void)select_input({{"P", "Ifd"}, 1.0, 3.0, 0, InputForm::absolute}, header);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(e.problems().size(), 3u) << e.what();
    EXPECT_NE(std::string(e.what()).find("Ifd"), std::string::npos);
  }
}

TEST(ShardStream, IsTheSameInMemoryAndFromShardsForAnyNumberOfReaders) {
  test::Folder folder("stream");
  const mpi::store::Dataset dataset = test::make_dataset(folder.path);
  const ShardStream memory(dataset, test::whole_record());
  ASSERT_TRUE(memory.in_memory());
  const auto order = epoch_order(test::all_rows(dataset.rows), 5, 2);
  std::vector<float> expected;
  BatchReader from_memory(memory, order, 32);
  for (Batch b; from_memory.next(b);) expected.insert(expected.end(), b.series.begin(), b.series.end());
  for (const unsigned readers : {1u, 2u, 3u}) {
    const ShardStream disk(dataset, test::whole_record(), {.memory_limit = 0, .readers = readers});
    ASSERT_FALSE(disk.in_memory());
    BatchReader reader(disk, order, 32);
    std::vector<float> got;
    for (Batch b; reader.next(b);) got.insert(got.end(), b.series.begin(), b.series.end());
    EXPECT_EQ(got, expected) << readers << " readers";
  }
}

TEST(ShardStream, RefusesAValueThatIsNotANumber) {
  test::Folder folder("nan");
  test::Plan plan;
  plan.rows = 30;
  plan.rows_per_shard = 10;
  plan.spoil_row = 17;
  const mpi::store::Dataset dataset = test::make_dataset(folder.path, plan);
  try {
    const ShardStream stream(dataset, test::whole_record());
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("shard-1.h5, row 7"), std::string::npos) << e.what();
  }
}

std::string refusal(const mpi::store::Dataset& dataset, const StreamOptions& options) {
  try {
    const ShardStream stream(dataset, test::whole_record(), options);
    return "accepted";
  } catch (const InputError& e) {
    return e.what();
  }
}

/// Changes shard 1. Its journal line gets the new length and file hash, but keeps the hash of the old rows.
mpi::store::Dataset with_shard_1_changed(const mpi::store::Dataset& dataset,
                                         const std::function<void(mpi::store::ShardData&)>& change) {
  const auto file = dataset.shards[1].path;
  mpi::store::ShardData data = mpi::store::read_shard(file);
  change(data);
  mpi::store::write_shard(file, data);
  auto lines = mpi::store::read_journals(dataset.path);
  lines[1].bytes = std::filesystem::file_size(file);
  lines[1].file_hash = hash_of_file(file);
  std::string text;
  for (const auto& line : lines) text += mpi::store::journal_text(line);
  write_text(dataset.path / "journal.jsonl", text);
  return mpi::store::open_dataset(dataset.path);
}

TEST(ShardStream, RefusesDataThatContradictTheJournalUnlessTrusted) {
  test::Folder folder("altered");
  const mpi::store::Dataset altered =
      with_shard_1_changed(test::make_dataset(folder.path), [](mpi::store::ShardData& d) {
        for (double& p : d.parameters) p *= 1.5;
      });
  for (const std::uint64_t limit : {std::uint64_t{0}, std::uint64_t{1} << 30}) {
    const std::string sentence = refusal(altered, {.memory_limit = limit});
    EXPECT_NE(sentence.find("changed shard at " + altered.shards[1].path.string()), std::string::npos)
        << sentence;
    EXPECT_NE(sentence.find("--repair"), std::string::npos) << sentence;
    EXPECT_EQ(refusal(altered, {.memory_limit = limit, .trust = true}), "accepted");
  }
}

TEST(ShardStream, RefusesOtherShapesTrustedOrNot) {
  const std::function<void(mpi::store::ShardData&)> changes[] = {
      [](mpi::store::ShardData& d) { d.samples = 3; },
      [](mpi::store::ShardData& d) { d.attributes.channel_names = {"P"}, d.channels = 1; },
      [](mpi::store::ShardData& d) {
        d.attributes.parameter_names = {"H", "D"}, d.parameter_count = 2;
      },
      [](mpi::store::ShardData& d) { d.rows = 100; }};
  for (const auto& change : changes)
    for (const bool trust : {false, true}) {
      test::Folder folder("shapes");
      const mpi::store::Dataset dataset = with_shard_1_changed(test::make_dataset(folder.path), change);
      EXPECT_NE(refusal(dataset, {.trust = trust}).find("wrong shape of /"), std::string::npos)
          << refusal(dataset, {.trust = trust});
    }
}

TEST(ShardStream, TrustDoesNotChangeTheData) {
  test::Folder folder("trust");
  const mpi::store::Dataset dataset = test::make_dataset(folder.path);
  const ShardStream checked(dataset, test::whole_record()),
      trusted(dataset, test::whole_record(), {.trust = true});
  EXPECT_EQ(checked.labels().values, trusted.labels().values);
  EXPECT_EQ(checked.labels().generator, trusted.labels().generator);
  const auto rows = test::all_rows(dataset.rows);
  std::vector<float> a(dataset.rows * checked.selection().values()), b(a.size());
  checked.read(rows, a.data());
  trusted.read(rows, b.data());
  EXPECT_EQ(a, b);
}

TEST(EpochOrder, DependsOnSeedAndEpochOnly) {
  const auto rows = test::all_rows(40000);
  const auto order = epoch_order(rows, 1, 0);
  EXPECT_EQ(order, epoch_order(rows, 1, 0));
  EXPECT_NE(order, epoch_order(rows, 1, 1));
  EXPECT_NE(order, epoch_order(rows, 2, 0));
  auto sorted = order;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, rows);
  // The mean displacement of a uniform shuffle is a third of the length. The order shuffles blocks of rows,
  // then rows within windows, and comes close to a third.
  double displacement = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) displacement += std::abs(double(order[i]) - double(i));
  EXPECT_GT(displacement / 40000.0 / 40000.0, 0.25);
}

TEST(BatchReader, StartsInTheMiddleWithTheSameBatches) {
  test::Folder folder("middle");
  const mpi::store::Dataset dataset = test::make_dataset(folder.path);
  for (const std::uint64_t limit : {std::uint64_t{0}, std::uint64_t{1} << 30}) {
    const ShardStream stream(dataset, test::whole_record(), {.memory_limit = limit, .readers = 1});
    const auto order = epoch_order(test::all_rows(dataset.rows), 1, 0);
    BatchReader whole(stream, order, 48), rest(stream, order, 48, 3);
    Batch a, b;
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(whole.next(a));
    std::size_t batches = 0;
    while (whole.next(a)) {
      ASSERT_TRUE(rest.next(b));
      EXPECT_EQ(a.series, b.series);
      ++batches;
    }
    EXPECT_FALSE(rest.next(b));
    EXPECT_EQ(batches, 6u);  // 400 rows make 9 batches of at most 48
  }
}

TEST(Split, KeepsRowsOfADatabankPointTogether) {
  test::Folder folder("point");
  test::Plan plan;
  plan.rows_per_point = 4;
  const mpi::store::Dataset dataset = test::make_dataset(folder.path, plan);
  const ShardStream stream(dataset, test::whole_record());
  const RowSplit split = split_by_point(stream.labels(), 1);
  EXPECT_EQ(split.train.size(), 240u);
  EXPECT_EQ(split.validation.size(), 80u);
  EXPECT_EQ(split.test.size(), 80u);
  const auto points = [](const std::vector<std::uint64_t>& rows) {
    std::set<std::uint64_t> set;
    for (const auto r : rows) set.insert(r / 4);
    return set;
  };
  for (const auto p : points(split.test)) {
    EXPECT_FALSE(points(split.train).contains(p));
    EXPECT_FALSE(points(split.validation).contains(p));
  }
  EXPECT_NE(split.test, split_by_point(stream.labels(), 2).test);
  const RowSplit rows = split_by_row(stream.labels(), 1);
  EXPECT_EQ(rows.train.size(), 240u);
  EXPECT_EQ(rows.test.size(), 80u);
  std::size_t known = 0;
  for (const auto p : points(rows.test)) known += points(rows.train).contains(p) ? 1 : 0;
  EXPECT_GT(known, points(rows.test).size() / 2);
}

TEST(Split, KeepsRowsOfAnEventTogether) {
  Labels labels;
  labels.rows = labels.judged = 200;
  labels.parameters = 1;
  for (std::size_t i = 0; i < labels.rows; ++i) {
    labels.values.push_back(static_cast<double>(i));
    labels.sample_id.push_back(i / 5);
    labels.generator.push_back(30);
  }
  const RowSplit split = split_by_point(labels, 1);
  std::set<std::uint64_t> seen;
  for (const auto* part : {&split.train, &split.validation, &split.test}) {
    std::set<std::uint64_t> own;
    for (const auto r : *part) own.insert(labels.sample_id[r]);
    for (const auto event : own) EXPECT_TRUE(seen.insert(event).second) << event;
  }
  EXPECT_EQ(seen.size(), 40u);
}

/// 400 rows for training and test, and 170 training rows of another dataset.
struct TwoDatasets {
  test::Folder folder, other;
  mpi::store::Dataset dataset = test::make_dataset(folder.path), more;
  ShardStream stream;
  explicit TwoDatasets(const std::string& name)
      : folder(name),
        other(name + "-other"),
        more(test::make_dataset(other.path, plan())),
        stream(dataset, test::whole_record(), {}, more) {}
  static test::Plan plan() {
    test::Plan p;
    p.seed = 12;
    p.rows = 170;
    return p;
  }
};

TEST(Split, RowsOfASecondDatasetOnlyTrain) {
  const TwoDatasets two("more");
  const Labels& labels = two.stream.labels();
  ASSERT_EQ(labels.rows, 570u);
  ASSERT_EQ(labels.judged, 400u);
  const RowSplit split = leave_one_out(labels, {33, 0.1, 1});
  EXPECT_EQ(split.test.size(), 40u);
  EXPECT_EQ(split.validation.size(), 36u);
  EXPECT_EQ(split.train.size(), 324u + 153u);
  for (const auto r : split.train) EXPECT_NE(labels.generator[r], 33);
  // A row of the second dataset, for series in memory and on disk.
  const ShardStream own(two.more, test::whole_record()),
      disk(two.dataset, test::whole_record(), {.memory_limit = 0}, two.more);
  std::vector<float> a(two.stream.selection().values()), b = a, c = a;
  const std::uint64_t there = 451, here = 51;
  two.stream.read({&there, 1}, a.data());
  own.read({&here, 1}, b.data());
  disk.read({&there, 1}, c.data());
  EXPECT_EQ(a, b);
  EXPECT_EQ(a, c);
}

TEST(Split, SomeRowsAreOfAllGenerators) {
  std::vector<std::uint64_t> rows(1000);
  std::iota(rows.begin(), rows.end(), std::uint64_t{0});
  EXPECT_EQ(some_of(rows, 1000), rows);
  const std::vector<std::uint64_t> some = some_of(rows, 100);
  EXPECT_EQ(some.size(), 100u);
  EXPECT_TRUE(std::ranges::is_sorted(some));
  std::set<std::uint64_t> distinct(some.begin(), some.end()), generators;
  EXPECT_EQ(distinct.size(), 100u);
  for (const auto row : some) generators.insert(row % 10);  // ten generators, one row after the other
  EXPECT_EQ(generators.size(), 10u);
}

TEST(Split, GeneratorsSetAsideCalibrateAndDoNotTrain) {
  test::Folder folder("aside"), other("aside-other");
  const mpi::store::Dataset dataset = test::make_dataset(folder.path), more = test::make_dataset(other.path);
  const ShardStream stream(dataset, test::whole_record(), {}, more);
  const Labels& labels = stream.labels();
  const RowSplit split =
      leave_one_out(labels, {.generator = 33, .validation_share = 0.1, .seed = 1, .set_aside = 2});
  ASSERT_EQ(split.set_aside.size(), 2u);
  EXPECT_EQ(split.test.size(), 40u);
  EXPECT_EQ(split.calibration.size(), 160u);
  // Both datasets contain the same samples; those of validation rows are no training rows in either.
  EXPECT_EQ(split.train.size(), 2 * (280u - split.validation.size()));
  std::vector<std::uint64_t> kept = split.train;
  leave_out(kept, labels, held_out(labels, split));
  EXPECT_EQ(kept, split.train);
  const auto aside = [&](std::uint64_t row) {
    return std::ranges::find(split.set_aside, labels.generator[row]) != split.set_aside.end();
  };
  EXPECT_TRUE(std::ranges::all_of(split.calibration, aside));
  for (const auto* rows : {&split.train, &split.validation, &split.test})
    EXPECT_TRUE(std::ranges::none_of(*rows, aside));
  for (const auto row : split.train) EXPECT_NE(labels.generator[row], 33);
}

TEST(ShardStream, RefusesASecondDatasetOfAnotherKind) {
  test::Folder folder("kind"), other("kind-other");
  test::Plan plan;
  plan.rate = 40.0;
  const mpi::store::Dataset dataset = test::make_dataset(folder.path),
                            more = test::make_dataset(other.path, plan);
  try {
    const ShardStream stream(dataset, test::whole_record(), {}, more);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("rate"), std::string::npos) << e.what();
  }
}

TEST(Split, LeavesOutEveryRowOfTheGenerator) {
  test::Folder folder("out");
  const mpi::store::Dataset dataset = test::make_dataset(folder.path);
  const ShardStream stream(dataset, test::whole_record());
  const Labels& labels = stream.labels();
  const RowSplit split = leave_one_out(labels, {33, 0.1, 1});
  EXPECT_EQ(split.test.size(), 40u);
  EXPECT_EQ(split.validation.size(), 36u);
  EXPECT_EQ(split.train.size(), 324u);
  for (const auto r : split.test) EXPECT_EQ(labels.generator[r], 33);
  for (const auto* part : {&split.train, &split.validation})
    for (const auto r : *part) EXPECT_NE(labels.generator[r], 33);
  EXPECT_EQ(generators(labels).size(), 10u);
  EXPECT_THROW((void)leave_one_out(labels, {99, 0.1, 1}), InputError);
  const RowSplit nested =
      leave_one_out(labels, {33, 0.1, 1, 34});  // 33 is excluded, 34 is the test generator
  EXPECT_EQ(nested.test.size(), 40u);
  EXPECT_EQ(nested.train.size() + nested.validation.size(), 320u);
  for (const auto* part : {&nested.train, &nested.validation, &nested.test})
    for (const auto r : *part) EXPECT_EQ(labels.generator[r] == 34, part == &nested.test);
  for (const auto* part : {&nested.train, &nested.validation, &nested.test})
    for (const auto r : *part) EXPECT_NE(labels.generator[r], 33);
}

TEST(Split, PartialDataAreTheFirstRowsOfBothDatasets) {
  const TwoDatasets two("share");
  const ShardStream& stream = two.stream;
  const RowSplit whole = leave_one_out(stream.labels(), {33, 0.1, 1});
  RowSplit half = whole;
  keep_share(half, stream.labels(), 0.5);
  EXPECT_EQ(half.train.size(), 162u + 77u);
  EXPECT_EQ(half.test, whole.test);
  EXPECT_EQ(half.validation, whole.validation);
  EXPECT_TRUE(std::includes(whole.train.begin(), whole.train.end(), half.train.begin(), half.train.end()));
  EXPECT_THROW(keep_share(half, stream.labels(), 1e-6), InputError);
}

TEST(Features, AreFittedToTrainingRowsOnly) {
  test::Folder folder("fit"), spoilt("spoilt");
  test::Plan plan;
  const mpi::store::Dataset dataset = test::make_dataset(folder.path, plan);
  plan.shift_generator = 33;  // the records of the left-out generator are shifted far away
  const mpi::store::Dataset moved = test::make_dataset(spoilt.path, plan);
  const ShardStream a(dataset, test::whole_record()), b(moved, test::whole_record());
  const RowSplit split = leave_one_out(a.labels(), {33, 0.1, 1});
  for (const std::size_t components : {0u, 5u}) {
    const Features fa = Features::fit(a, split.train, components),
                   fb = Features::fit(b, split.train, components);
    EXPECT_EQ(fa.scale().mean, fb.scale().mean);
    EXPECT_EQ(fa.scale().deviation, fb.scale().deviation);
    const Features all = Features::fit(b, test::all_rows(b.labels().rows), components);
    EXPECT_NE(all.scale().mean, fb.scale().mean);  // the shift would be visible if those rows were used
  }
}

TEST(Features, GiveZeroMeanAndUnitVariance) {
  test::Folder folder("unit");
  const ShardStream stream(test::make_dataset(folder.path), test::whole_record());
  const auto rows = test::all_rows(300);
  for (const std::size_t components : {0u, 5u}) {
    const Features f = Features::fit(stream, rows, components);
    std::vector<float> series(rows.size() * stream.selection().values()),
        x(rows.size() * f.channels() * f.length());
    stream.read(rows, series.data());
    f.apply(series.data(), rows.size(), x.data());
    double sum = 0.0, square = 0.0;
    for (const float v : x) sum += v, square += double(v) * v;
    EXPECT_NEAR(sum / double(x.size()), 0.0, 1e-4);  // single-precision inputs of order 1
    EXPECT_NEAR(square / double(x.size()), 1.0, 1e-3);
  }
}

TEST(Pca, ReconstructionErrorMatchesItsReport) {
  test::Folder folder("pca");
  const ShardStream stream(test::make_dataset(folder.path), test::whole_record());
  const auto rows = test::all_rows(400);
  double last = 1.0;
  for (const std::size_t components : {1u, 3u, 6u, 20u}) {
    const Pca pca = Pca::fit(stream, rows, components);
    EXPECT_EQ(pca.length(), 2 * components);
    double worst = 0.0;
    const std::size_t values = stream.selection().values(), samples = stream.samples();
    std::vector<float> x(400 * values), score(2 * pca.length()), back(values);
    stream.read(rows, x.data());
    for (std::size_t c = 0; c < 2; ++c) {
      // Energy of the residual divided by the variance of the one-second segments about their mean.
      std::vector<double> mean(20);
      for (std::size_t i = 0; i < 400 * samples; ++i)
        mean[i % 20] +=
            x[(i / samples) * values + c * samples + i % samples] / (400.0 * double(samples) / 20.0);
      double lost = 0.0, total = 0.0;
      for (std::size_t r = 0; r < 400; ++r) {
        pca.apply(x.data() + r * values, score.data());
        pca.reconstruct(score.data(), back.data());
        for (std::size_t i = 0; i < samples; ++i) {
          const double v = x[r * values + c * samples + i];
          lost += std::pow(v - back[c * samples + i], 2);
          total += std::pow(v - mean[i % 20], 2);
        }
      }
      worst = std::max(worst, lost / total);
    }
    EXPECT_NEAR(pca.error(), worst, 1e-5);  // single-precision reconstruction of values of order 1
    EXPECT_LE(worst, last + 1e-9);
    last = worst;
  }
  EXPECT_LT(last, 1e-9);  // 20 components of 20 samples are complete
}

TEST(Pca, RefusesFractionsOfASecond) {
  test::Folder folder("second");
  const mpi::store::Dataset dataset = test::make_dataset(folder.path);
  auto recipe = test::whole_record();
  recipe.end_s = 1.5;
  const ShardStream stream(dataset, recipe);
  EXPECT_THROW((void)Pca::fit(stream, test::all_rows(10), 5), InputError);
}

TEST(TargetScale, IsFittedOnTheGivenRows) {
  const std::vector<double> values = {1.0, 0.3, 3.0, 0.3, 100.0, 0.3};
  const auto scale = TargetScale::fit(values, 2, std::vector<std::uint64_t>{0, 1});
  EXPECT_EQ(scale.mean, (std::vector<double>{2.0, 0.3}));
  EXPECT_EQ(scale.unit,
            (std::vector<double>{1.0, 0.3}));  // standard deviation of 1 and 3; magnitude of the constant
}

}  // namespace
}  // namespace swingbank::train::data
