// Figures as text.
#include "validate/report/figures.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace swingbank::validate::report {
namespace {

TEST(Figures, ProbabilityNeverStatesCertainty) {
  EXPECT_EQ(probability_text(1.0), "> 99 %");
  EXPECT_EQ(probability_text(0.0), "< 1 %");
  EXPECT_EQ(probability_text(0.97), "97 %");
  EXPECT_EQ(probability_text(0.9951), "> 99 %");
}

TEST(Figures, MultipleOfNoiseHasTwoDigits) {
  EXPECT_EQ(ratio_text(0.94), "0.9");
  EXPECT_EQ(ratio_text(1339.2), "1339");
  EXPECT_EQ(times_noise(0.94), "0.9 ×");
  EXPECT_EQ(times_noise(9.96), "10 ×");
  EXPECT_EQ(times_noise(84.7), "85 ×");
  EXPECT_EQ(times_noise(std::numeric_limits<double>::quiet_NaN()), "–");
}

}  // namespace
}  // namespace swingbank::validate::report
