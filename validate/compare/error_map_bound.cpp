// Bounds of an error map under noise alone: quantiles of the chi-square and F distributions.
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "validate/compare/error_map.hpp"

namespace swingbank::validate::compare {

double noise_bound(int values, int freedom, double probability) {
  using namespace boost::math;
  if (freedom <= 0) return std::sqrt(quantile(complement(chi_squared(values), probability)) / values);
  return std::sqrt(quantile(complement(fisher_f(values, freedom), probability)));
}

}  // namespace swingbank::validate::compare
