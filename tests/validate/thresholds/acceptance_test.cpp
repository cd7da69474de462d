// Limits of fitness: presets, files and their errors, and exit codes.
#include "validate/thresholds/acceptance.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "base/problem.hpp"
#include "validate/thresholds/thresholds.hpp"

namespace swingbank::validate::thresholds {
namespace {

using testing::HasSubstr;

const char* const kHead = "name = \"ours\"\nsource = \"our grid code, 4.2\"\n";

std::string refused(const std::string& text) {
  try {
    parse_acceptance(text, "limits.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Acceptance, DefaultIsThePresetForMeasuredReferences) {
  const Acceptance a = read_acceptance("");
  EXPECT_EQ(a.name, "dtr-test");
  EXPECT_EQ(a.of(0, Phase::fault).mxe, 10);
  EXPECT_EQ(a.of(1, Phase::post_fault).me, 4);
  EXPECT_EQ(a.after_clearing, 0.06);
  EXPECT_EQ(a.movement, 25);
  EXPECT_EQ(read_acceptance("dtr-simulation").of(0, Phase::post_fault).mae, 3);
}

TEST(Acceptance, FileModifiesAPreset) {
  const Acceptance a = parse_acceptance(
      std::string(kHead) +
          "preset = \"dtr-test\"\n[Q.fault]\nmxe = 15\n[left_out]\nafter_clearing = 0.5\n[movement]\nerror = 12\n",
      "limits.toml");
  EXPECT_EQ(a.name, "ours");
  EXPECT_EQ(a.of(1, Phase::fault).mxe, 15);
  EXPECT_EQ(a.of(0, Phase::fault).mxe, 10);
  EXPECT_EQ(a.of(1, Phase::fault).me, 5);
  EXPECT_EQ(a.after_clearing, 0.5);
  EXPECT_EQ(a.movement, 12);
  EXPECT_EQ(a.after_fault, 0.02);
}

TEST(Acceptance, ReportsAllFaultsOfAFileAtOnce) {
  const std::string text = refused(std::string(kHead) +
                                   "preset = \"dtr-test\"\n[P.fault]\nmxe = nan\nme = 0\nmae = -1\nmax = 3\n"
                                   "[left_out]\nafter_fault = 0.2\n");
  for (const char* part :
       {"limits.toml:5", "limits.toml:6", "limits.toml:7", "limits.toml:8", "limits.toml:10", "0 to 0.14 s"})
    EXPECT_THAT(text, HasSubstr(part)) << text;
}

TEST(Acceptance, RequiresEveryLimit_WithoutAPreset) {
  const std::string text = refused(kHead);
  for (const char* part : {"P.pre_fault.mxe", "P.fault.me", "Q.post_fault.mae"})
    EXPECT_THAT(text, HasSubstr(part));
  EXPECT_THAT(refused("preset = \"dtr-test\"\n"), HasSubstr("source"));
  EXPECT_THAT(refused(std::string(kHead) + "preset = \"nerc\"\n"), HasSubstr("dtr-simulation"));
}

TEST(Acceptance, ListsThePresetsForUnknownName) {
  try {
    read_acceptance("nonesuch");
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("dtr-test, dtr-simulation"));
  }
}

TEST(Acceptance, NamesTheErrorNearestToItsLimit) {
  const Errors limits{8, 4, 7};
  EXPECT_EQ(nearest({4, -3.9, 1}, limits).name, "ME");
  EXPECT_EQ(exceeding({8, -4, 7}, limits), 0);
  EXPECT_EQ(exceeding({8.001, -4.001, 7.001}, limits), 3);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(exceeding({nan, nan, nan}, limits), 3);
  EXPECT_EQ(nearest({nan, 0, 0}, limits).name, "MXE");
}

TEST(Acceptance, ExitCodesEncodeBothVerdicts) {
  EXPECT_EQ(exit_code(true, true), 0);
  EXPECT_EQ(exit_code(false, false), 3);
  EXPECT_EQ(exit_code(false, true), 4);
  EXPECT_EQ(exit_code(true, false), 5);
}

}  // namespace
}  // namespace swingbank::validate::thresholds
