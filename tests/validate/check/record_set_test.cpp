// Reading, naming and checking the records of one plant together, with one report of all problems.
#include "validate/check/record_set.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/validate/playin/support.hpp"

namespace swingbank::validate::check {
namespace {

const std::string kFirst = test::source("configs/records/record-example/avr_ev1.csv").string(),
                  kSecond = test::source("configs/records/record-example/avr_ev2.csv").string();

struct RecordSets : ::testing::Test {
  plant::PlantModel model = plant::load_plant_model(test::source("configs/plants/ieee14_bus2.toml"));
};

TEST_F(RecordSets, KeepTheOrderGiven) {
  const RecordSet set = read_records({kSecond, kFirst}, model);
  ASSERT_EQ(set.records.size(), 2U);
  EXPECT_EQ(set.records.front().name, "avr_ev2.csv");
  EXPECT_EQ(set.warnings.size(), 2U);
}
TEST_F(RecordSets, ReportEveryProblemOfEveryFileAtOnce) {
  model.plant.mva = 1;  // the records' power is then forty times the machine's rating
  try {
    read_records({kFirst, "none.csv", kFirst}, model);
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_THAT(message, ::testing::HasSubstr("none.csv"));
    EXPECT_THAT(message, ::testing::HasSubstr("two records named avr_ev1.csv"));
    EXPECT_GE(error.problems().size(), 3U) << message;  // the third: the check refuses the record
  }
}
TEST_F(RecordSets, AppendToKnownProblems) {
  Problems problems;
  problems.add("a plant", "plants.csv", "it has no name", "give it one");
  const RecordSet set = read_records({kFirst, "none.csv"}, model, problems);
  EXPECT_EQ(set.records.size(), 1U);
  EXPECT_THROW(problems.raise(), InputError);
}
/// Only Q is reversed. The steps of avr_ev2 alone would suggest that P is reversed too.
TEST_F(RecordSets, HaveTheMistakeThatExplainsAllOfThem) {
  const auto reversed = [](record::Record r) {
    for (double& q : r.Q) q = -q;
    return r;
  };
  const auto remedies = [&](const std::vector<std::string>& files) {
    Problems problems;
    read_records(files, model, problems, reversed);
    std::vector<std::string> all;
    for (const Problem& p : problems.list()) all.push_back(p.remedy);
    return all;
  };
  EXPECT_THAT(remedies({kSecond}), ::testing::ElementsAre(::testing::HasSubstr("signs of P and Q")));
  EXPECT_THAT(remedies({kFirst}), ::testing::ElementsAre(::testing::HasSubstr("sign of Q")));
  for (const auto& files : {std::vector{kFirst, kSecond}, {kSecond, kFirst}})
    EXPECT_THAT(remedies(files), ::testing::Each(::testing::HasSubstr("sign of Q")));
}
TEST_F(RecordSets, SkipTheCheckWithoutAModel) {
  Problems problems;
  EXPECT_EQ(read_records({kFirst}, plant::PlantModel{}, problems).records.size(), 1U);
  EXPECT_TRUE(problems.empty());
}

}  // namespace
}  // namespace swingbank::validate::check
