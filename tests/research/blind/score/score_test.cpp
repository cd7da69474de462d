// Scores of blind runs from hand-written truths and verdicts.
#include "research/blind/score/score.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include "base/write_file.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/hypothesis/posterior.hpp"

namespace swingbank::research::blind::score {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class BlindScoring : public testing::Test {
 protected:
  BlindScoring() {
    fs::remove_all(run_);
    fs::create_directories(run_ / "cases");
  }
  ~BlindScoring() override { fs::remove_all(run_); }

  struct Hidden {
    const char *kind, *side, *accepted_name;
    double size;
    bool listed = true, value = false;
  };
  void add(const std::vector<Hidden>& effects, const BlindVerdict& verdict, bool channels = false,
           const std::vector<std::string>& conditions = {}) {
    const std::string name = "c" + std::to_string(++count_);
    json hidden = json::array();
    for (const Hidden& h : effects)
      hidden.push_back({{"kind", h.kind},
                        {"side", h.side},
                        {"answers", {h.accepted_name}},
                        {"listed", h.listed},
                        {"value", h.value},
                        {"left_noise", 10 * h.size},
                        {"limit_noise", 10}});
    json truth = {{"case", name}, {"channels", channels ? "P,Q,speed,Ifd" : "P,Q"}, {"hidden", hidden}};
    if (!conditions.empty()) truth["conditions"] = conditions;
    write_file(run_ / "truth" / (name + ".json"), truth.dump());
    write_file(run_ / "verdicts" / (name + ".json"), verdict_json(verdict));
    fs::create_directories(run_ / "cases" / name);
  }
  [[nodiscard]] BlindScore score() const {
    return score_blind(run_, validate::test::source("configs/blind/targets.toml"));
  }

  fs::path run_ = fs::path(testing::TempDir()) / ("blind_score_" + std::to_string(::getpid()));
  int count_ = 0;
};

TEST(BlindRate, WilsonInterval) {
  // Closed form by hand: the interval of 10 of 10 begins at 1/(1 + z^2/10), and that of 5 of 10 is symmetric
  // about 0.5.
  const Rate all{10, 10}, half{5, 10}, none{};
  EXPECT_NEAR(all.low(), 0.72247, 1e-5);
  EXPECT_DOUBLE_EQ(all.high(), 1.0);
  EXPECT_NEAR(half.low(), 0.23659, 1e-5);
  EXPECT_NEAR(half.high(), 0.76341, 1e-5);
  EXPECT_EQ(none.low(), 0.0);
  EXPECT_EQ(none.high(), 1.0);
}

TEST_F(BlindScoring, CountsEachRate) {
  const Hidden sexs{"SEXS", "excitation", "SEXS", 5}, droop{"TGOV1", "mechanical", "TGOV1", 3};
  add({sexs}, {"missing", {"sexs"}, {}, "excitation", 1});
  add({sexs}, {"missing", {"TGOV1"}, {}, "mechanical", 2});
  add({sexs}, {"confusable", {"EXST1"}, {"EXST1", "SEXS"}, "excitation", 3});
  add({{"SEXS", "excitation", "SEXS", 1.5}},
      {"adequate", {}, {}, "none", 1});  // below 2 detection limits: excluded
  add({}, {"adequate", {}, {}, "none", 1});
  add({}, {"missing", {"SEXS"}, {}, "excitation", 1});
  add({{"saw", "mechanical", "saw", 5, false}}, {"unexplained", {}, {}, "mechanical", 1});
  add({sexs, droop}, {"missing", {"TGOV1", "SEXS"}, {}, "excitation", 9});
  const BlindScore s = score();
  const auto rate = [&](const char* name) {
    const Rate& r = s.rates.at(name);
    return std::pair(r.hits, r.n);
  };
  EXPECT_EQ(rate("right first, P, Q only"), std::pair(1, 3));
  EXPECT_EQ(rate("right or in the set, P, Q only"), std::pair(2, 3));
  EXPECT_EQ(rate("side"), std::pair(4, 5));
  EXPECT_EQ(rate("nothing hidden: adequate"), std::pair(1, 2));
  EXPECT_EQ(rate("false positive"), std::pair(1, 2));
  EXPECT_EQ(rate("outside the list: none of these"), std::pair(1, 1));
  EXPECT_EQ(rate("two effects: both named"), std::pair(1, 1));
  EXPECT_EQ(s.by_size.at("P, Q only")[1].n, 1);  // 1-2 detection limits
  EXPECT_EQ(s.by_size.at("P, Q only")[3].n, 3);  // 4-7 detection limits
  EXPECT_EQ(s.confusion.at("SEXS").at("TGOV1"), 1);
  EXPECT_EQ(s.confusion.at("nothing").at("adequate"), 1);
  EXPECT_DOUBLE_EQ(s.longest_seconds, 9.0);
}

TEST_F(BlindScoring, CountsRightVerdictsByCondition) {
  const Hidden sexs{"SEXS", "excitation", "SEXS", 5}, unlisted{"sawtooth", "mechanical", "ODD", 3, false};
  add({sexs}, {"missing", {"SEXS"}, {}, "excitation", 1}, false, {"30/s", "class M"});
  add({sexs}, {"missing", {"TGOV1"}, {}, "mechanical", 1}, false, {"30/s"});
  add({{"SEXS", "excitation", "SEXS", 1.5}}, {"adequate", {}, {}, "none", 1}, false,
      {"30/s"});  // below 2 detection limits
  add({}, {"adequate", {}, {}, "none", 1}, false, {"30/s"});
  add({unlisted}, {"adequate", {}, {}, "none", 1}, false, {"class M"});
  add({sexs, unlisted}, {"unexplained", {}, {}, "none", 1}, false, {"class M"});  // counts as unlisted
  add({sexs}, {"missing", {"SEXS"}, {}, "excitation", 1});
  const BlindScore s = score();
  ASSERT_EQ(s.by_condition.size(), 2U);
  const ByCondition &slow = s.by_condition.at("30/s"), &m = s.by_condition.at("class M");
  EXPECT_EQ(slow.one.n, 2);
  EXPECT_EQ(slow.one.hits, 1);
  EXPECT_EQ(slow.nothing.hits, 1);
  EXPECT_EQ(slow.outside.n, 0);
  EXPECT_EQ(m.one.hits, 1);
  EXPECT_EQ(m.outside.n, 2);
  EXPECT_EQ(m.outside.hits, 1);
  EXPECT_THAT(score_markdown(s), testing::HasSubstr("| class M | – | 100.0 % (1 of 1;"));
}

TEST_F(BlindScoring, WrongValueMustBeNamedWithoutMissingEffect) {
  const Hidden gain{"Ki", "none", "REPCA1.Ki", 5, true, true};
  BlindVerdict named{"adequate", {}, {}, "none", 1};
  named.wrong = {"REPCA1.Ki"};
  BlindVerdict more = named, other = named, missing{"missing", {"SEXS"}, {}, "excitation", 1};
  named.probabilities = {{validate::hypothesis::kNothingMissing, 0.9}, {"SEXS", 0.1}};
  more.wrong.emplace_back("REECA1.Kvi");
  other.wrong = {"REECA1.Kvi"};
  for (const BlindVerdict& v : {named, more, other, missing}) add({gain}, v, false, {"30/s"});
  const BlindScore s = score();
  EXPECT_EQ(s.rates.at("wrong value: nothing missing").hits, 3);
  EXPECT_EQ(s.rates.at("wrong value: named").hits, 2);
  EXPECT_EQ(s.rates.at("wrong value: named and no other").hits, 1);
  EXPECT_EQ(s.rates.at("wrong value: named").n, 4);
  EXPECT_EQ(s.rates.count("right first, P, Q only"), 0U);
  EXPECT_THAT(s.cases.front().forecast().right, testing::ElementsAre(1, 0));
  EXPECT_EQ(s.by_condition.at("30/s").value.hits, 2);
  EXPECT_EQ(s.by_condition.at("30/s").one.n, 0);
}
TEST_F(BlindScoring, PairIsInTheSet_WhenOneEntryNamesBoth) {
  const Hidden sexs{"SEXS", "excitation", "SEXS", 5}, droop{"TGOV1", "mechanical", "TGOV1", 3};
  const auto in_set = [&](const BlindVerdict& verdict) {
    add({sexs, droop}, verdict);
    const BlindScore s = score();
    return s.cases.back().all_in_set() && !s.cases.back().all_named();
  };
  EXPECT_TRUE(in_set({"confusable", {"EXST1", "HYGOV"}, {"EXST1 + TGOV1", "TGOV1 + SEXS"}, "excitation", 1}));
  EXPECT_FALSE(in_set({"confusable", {"EXST1", "HYGOV"}, {"EXST1 + TGOV1", "SEXS + HYGOV"}, "excitation", 1}))
      << "one correct effect in each entry is not the pair";
  EXPECT_FALSE(in_set({"confusable", {"SEXS"}, {"TGOV1"}, "excitation", 1}));
  EXPECT_FALSE(in_set({"missing", {"EXST1", "HYGOV"}, {"SEXS + TGOV1"}, "excitation", 1}));
  const BlindScore s = score();
  EXPECT_EQ(s.rates.at("two effects: both named").hits, 0);
  EXPECT_EQ(s.rates.at("two effects: both named or in the set").hits, 1);
}

TEST_F(BlindScoring, ComparesProbabilitiesWithTheTruth) {
  const Hidden sexs{"SEXS", "excitation", "SEXS", 5}, droop{"TGOV1", "mechanical", "TGOV1", 3};
  const auto says = [](std::vector<std::pair<std::string, double>> probabilities) {
    BlindVerdict v{"confusable", {"EXST1"}, {"SEXS"}, "excitation", 1};
    v.probabilities = std::move(probabilities);
    return v;
  };
  add({sexs}, says({{"EXST1", 0.5}, {"sexs", 0.4}, {"SEXS + TGOV1", 0.05}, {"none of these", 0.05}}));
  add({}, says({{"nothing missing", 0.6}, {"nothing missing, but wrong: GENROU.H", 0.3}, {"SEXS", 0.1}}));
  add({{"saw", "mechanical", "saw", 5, false}}, says({{"SEXS", 0.8}, {"none of these", 0.2}}));
  add({sexs, droop}, says({{"TGOV1 + SEXS", 0.9}, {"SEXS", 0.1}}));
  const BlindScore s = score();
  const auto right = [&](std::size_t k) { return s.cases[k].forecast().right; };
  EXPECT_THAT(right(0), testing::ElementsAre(0, 1, 0, 0, 0))
      << "a pair must not count as its single hidden effect";
  EXPECT_THAT(right(1), testing::ElementsAre(1, 0));
  EXPECT_THAT(right(2), testing::ElementsAre(0, 1, 0));
  EXPECT_THAT(right(3), testing::ElementsAre(1, 0, 0));
  EXPECT_EQ(s.reliability.cases, 4);
  EXPECT_EQ(s.reliability.sets.at(0).second.coverage.hits, 1);
  EXPECT_EQ(score_json(s)["probabilities"]["sets"]["P, Q only"]["mean_size"], 3.0);
  EXPECT_THAT(score_markdown(s), testing::HasSubstr("## Reliability of the probabilities"));
}
TEST_F(BlindScoring, RefusesUnorderedProbabilities) {
  BlindVerdict v{"missing", {"SEXS"}, {}, "excitation", 1};
  v.probabilities = {{"none of these", 0.1}, {"SEXS", 0.9}};
  add({{"SEXS", "excitation", "SEXS", 5}}, v);
  const auto all = validate::test::messages([&] { (void)score(); });
  ASSERT_EQ(all.size(), 1U);
  EXPECT_THAT(all[0], testing::HasSubstr("the most probable first"));
}

TEST_F(BlindScoring, CountsUnexplainedVerdictAsWrong) {
  add({{"SEXS", "excitation", "SEXS", 5}}, {"unexplained", {"SEXS"}, {"SEXS"}, "excitation", 1}, true);
  const BlindScore s = score();
  EXPECT_EQ(s.rates.at("right first, with speed, Ifd").hits, 0);
  EXPECT_EQ(s.rates.at("right or in the set, with speed, Ifd").hits, 0);
}

TEST_F(BlindScoring, TableMarksMissedTargets) {
  add({}, {"missing", {"SEXS"}, {}, "excitation", 1});
  const std::string text = score_markdown(score());
  EXPECT_THAT(text, testing::HasSubstr(
                        "| nothing hidden: adequate | 0.0 % (0 of 1; 0.0–79.3 %) | 98 % | **not met** |"));
  EXPECT_THAT(text, testing::HasSubstr("| right first, P, Q only | – | 85 % | not measured |"));
}

TEST_F(BlindScoring, ReportsEveryInvalidVerdict) {
  add({}, {"perhaps", {}, {}, "none", 1});
  add({}, {"adequate", {}, {}, "north", 1});
  const auto all = validate::test::messages([&] { (void)score(); });
  ASSERT_EQ(all.size(), 2U);
  EXPECT_THAT(all[0], testing::HasSubstr("'perhaps'"));
  EXPECT_THAT(all[1], testing::HasSubstr("'north'"));
}

TEST_F(BlindScoring, JudgesOnlyPendingCases) {
  add({}, {"adequate", {}, {}, "none", 1});
  fs::create_directories(run_ / "cases" / "c7");
  fs::create_directories(run_ / "cases" / "c8");
  std::vector<std::string> asked, reported;
  const BlindJudge judge = [&](const fs::path& folder) -> BlindVerdict {
    asked.push_back(folder.filename().string());
    if (asked.back() == "c8") throw InputError({"broken", "here", "why", "mend"});
    return {"adequate", {}, {}, "none", 2};
  };
  const auto report = [&](const std::string& name, const BlindVerdict&) { reported.push_back(name); };
  const auto faults = judge_cases(run_, judge, {1, 1}, report);
  EXPECT_THAT(asked, testing::ElementsAre("c7", "c8"));
  EXPECT_THAT(reported, testing::ElementsAre("c7"));
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_DOUBLE_EQ(read_verdict(run_ / "verdicts" / "c7.json").seconds, 2.0);
  EXPECT_FALSE(fs::exists(run_ / "verdicts" / "c8.json"));
}

}  // namespace
}  // namespace swingbank::research::blind::score
