// Random parameter sets: reproducible, consistent, and wide where the prior is.
#include "validate/fit/draws.hpp"

#include <gtest/gtest.h>

#include "sim/plant/usual.hpp"
#include "tests/validate/fit/exciter_example.hpp"

namespace swingbank::validate::fit {
namespace {

class DrawsTest : public testing::Test {
 protected:
  ExciterExample example_{0.2};
  std::vector<FreeParameter> free_ = example_.free({"TA_TB", "TB", "K", "TE", "EMIN", "EMAX"});

  [[nodiscard]] double start(std::size_t i) const {
    return sim::plant::parameter_value(example_.model.plant, free_[i].id);
  }
  [[nodiscard]] std::size_t index(std::string_view name) const {
    for (std::size_t i = 0; i < free_.size(); ++i)
      if (parameter_record(example_.model.plant, free_[i].id).name == name) return i;
    ADD_FAILURE() << name;
    return 0;
  }
};

TEST_F(DrawsTest, DependOnStreamAndNumberOnly) {
  const Draws one(example_.model.plant, free_, 1, 15.0), same(example_.model.plant, free_, 1, 15.0),
      other(example_.model.plant, free_, 2, 15.0);
  (void)same(0);
  EXPECT_EQ(one(7), same(7));
  EXPECT_NE(one(7), one(8));
  EXPECT_NE(one(7), other(7));
}
TEST_F(DrawsTest, StayWithinSearchRanges) {
  const Draws draw(example_.model.plant, free_, 3);
  for (std::uint64_t k = 0; k < 100; ++k) {
    const auto values = draw(k);
    ASSERT_TRUE(values);
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const auto range =
          sim::plant::search_range(parameter_record(example_.model.plant, free_[i].id), start(i));
      EXPECT_GE((*values)[i], range.low);
      EXPECT_LE((*values)[i], range.high);
    }
  }
}
/// An upper limit acts only if its drawn value is as low as the limited signal, far below the prior mean.
TEST_F(DrawsTest, ReachLowLimits) {
  const Draws draw(example_.model.plant, free_, 4);
  const std::size_t limit = index("EMAX");
  double lowest = start(limit);
  for (std::uint64_t k = 0; k < 100; ++k) lowest = std::min(lowest, draw(k).value()[limit]);
  EXPECT_LT(lowest, 0.2 * start(limit));
}
/// In every other draw the longest time constant is at most about the length of the records.
TEST_F(DrawsTest, BoundTimesByTheRecord) {
  const double length = 0.1;  // [s], far shorter than TB = 10 s
  const Draws draw(example_.model.plant, free_, 5, length);
  const std::size_t lag = index("TB");
  int longer = 0;
  for (std::uint64_t k = 1; k < 200; k += 2) longer += draw(k).value()[lag] > 2 * length;
  EXPECT_EQ(longer, 0);
}

}  // namespace
}  // namespace swingbank::validate::fit
