// Common content of the test records, in every format.
#pragma once
#include <gtest/gtest.h>

#include "validate/record/record.hpp"

namespace swingbank::validate::record {

inline const RecordBase kTestBase{200, 60, 138};

/// Expects V 1.02 pu and 0.4 + j0.1 pu on 200 MVA, written with at least 7 digits.
inline void expect_values(const Record& r) {
  ASSERT_GE(r.samples(), 60);
  EXPECT_NEAR(r.V[5], 1.02, 1e-6);
  EXPECT_NEAR(r.P[5], 0.4, 1e-6);
  EXPECT_NEAR(r.Q[5], 0.1, 1e-6);
}

}  // namespace swingbank::validate::record
