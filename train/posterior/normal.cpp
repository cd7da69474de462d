#include "train/posterior/normal.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>

namespace swingbank::train::posterior {

double normal_quantile(double p) {
  constexpr double kTail = 1e-12;
  return boost::math::quantile(boost::math::normal(), std::clamp(p, kTail, 1 - kTail));
}

}  // namespace swingbank::train::posterior
