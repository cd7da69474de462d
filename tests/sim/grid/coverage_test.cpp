// Coverage of a .dyr: unknown models, refused records, and lines that are no record.
#include "sim/grid/coverage.hpp"

#include <gmock/gmock.h>

#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::grid {
namespace {

using ::testing::HasSubstr;

const ModelCoverage& of(const Coverage& coverage, const std::string& name) {
  for (const ModelCoverage& m : coverage.models)
    if (m.name == name) return m;
  throw std::runtime_error("no model " + name);
}

TEST(Coverage, CountsRecordsOfAllFilesByModel) {
  const formats::ScratchFile one{"one.dyr"}, two{"two.dyr"};
  std::ofstream(one.path) << "1 'SEXS' 1 0.1 10 100 0.1 0 5 /\n"
                             "1 'NOSUCH' 1 1 2 /\n"
                             "2 'SEXS' 1 0.1 10 100 /\n";
  std::ofstream(two.path) << "1 'SEXS' 1 0.1 10 100 0.1 0 5 /\n"
                             "2 'SEXS'\n";
  const Coverage coverage = take_coverage({one.path, two.path});
  EXPECT_EQ(coverage.files, 2);
  EXPECT_EQ(coverage.records, 4);
  EXPECT_EQ(coverage.covered, 2);
  EXPECT_DOUBLE_EQ(coverage.percent(), 50.0);
  EXPECT_EQ(coverage.models.front().name, "SEXS");
  const ModelCoverage& sexs = of(coverage, "SEXS");
  EXPECT_EQ(sexs.records, 3);
  EXPECT_EQ(sexs.files, 2);
  EXPECT_EQ(sexs.covered(), 2);
  EXPECT_EQ(sexs.refused, 1);
  EXPECT_THAT(sexs.fault, HasSubstr("SEXS with 3 parameters"));
  EXPECT_EQ(of(coverage, "NOSUCH").covered(), 0);
  ASSERT_EQ(coverage.faults.size(), 1U);
  EXPECT_THAT(coverage.faults[0], HasSubstr("two.dyr:2"));
}

TEST(Coverage, AnotherNameOfAnEffectIsCovered) {
  const formats::ScratchFile file{"names.dyr"};
  std::ofstream(file.path) << "1 'EXDC1' 1 0 40 0.1 0 0 1 -1 0.1 0.5 0.05 0.7 0 2.8 0.08 3.7 0.33 /\n";
  EXPECT_EQ(of(take_coverage({file.path}), "EXDC1").effect, "IEEEX1");
}

TEST(Coverage, AWrappedModelIsCoveredWithCodesBeforeItsConstants) {
  const formats::ScratchFile file{"wrapped.dyr"};
  const std::string hyg3 =
      "1 0 .0527 2 0 1.5 4.5 0 .05 11 .15 .1 -.1 .918 0 0 .292 .374 .473 .603 .528 .681 .686 .82 .799 .893 "
      ".856 .929 1 .153 .23 1.181 .5 11.6 .036 0 -.036 /\n";
  std::ofstream(file.path) << "1 'HYG3U1' 1 " << hyg3 << "2 'USRMDL' 1 'HYG3U1' 5 0 1 36 9 20 " << hyg3;
  const Coverage coverage = take_coverage({file.path});
  EXPECT_EQ(of(coverage, "HYG3U1").effect, "HYG3");
  EXPECT_EQ(coverage.covered, 2) << of(coverage, "HYG3U1").fault;
}

TEST(Coverage, RefusesMissingFiles) { EXPECT_ANY_THROW(take_coverage({"/nowhere/none.dyr"})); }

}  // namespace
}  // namespace swingbank::sim::grid
