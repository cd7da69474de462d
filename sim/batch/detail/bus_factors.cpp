#include "sim/batch/detail/bus_factors.hpp"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <map>
#include <numeric>

namespace swingbank::sim::batch {

namespace {
constexpr double kLeastPivot = 1e-4;  ///< smallest accepted pivot, relative to the largest entry of U's row
}

bool BusFactors::factor(const Sparse& admittance) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(admittance, order);
  order_.assign(order.indices().data(), order.indices().data() + order.size());
  if (!eliminate(admittance)) return false;
  by_height();
  return eliminate(admittance);
}

bool BusFactors::eliminate(const Sparse& admittance) {
  const std::size_t n = order_.size();
  place_.resize(n);
  for (std::size_t k = 0; k < n; ++k) place_[static_cast<std::size_t>(order_[k])] = static_cast<int>(k);
  std::vector<std::map<int, Complex>> rows(n);
  for (int j = 0; j < admittance.outerSize(); ++j)
    for (Sparse::InnerIterator e(admittance, j); e; ++e)
      rows[static_cast<std::size_t>(place(static_cast<int>(e.row())))][place(j)] += e.value();
  lower_ = upper_ = {};
  inverse_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    auto& row = rows[i];
    const int own = static_cast<int>(i);
    double largest = 0.0;
    for (auto at = row.begin(); at != row.end() && at->first < own; ++at) {
      const auto j = static_cast<std::size_t>(at->first);
      for (std::size_t k = upper_.first[j]; k < upper_.first[j + 1]; ++k) {
        const auto& e = upper_.entries[k];
        row[e.column] -= at->second * Complex(e.r, e.i);
      }
      const Complex l = at->second * inverse_[j];
      lower_.entries.push_back({at->first, l.real(), l.imag()});
    }
    for (auto at = row.lower_bound(own); at != row.end(); ++at)
      largest = std::max(largest, std::abs(at->second));
    const Complex pivot = row[own];
    if (!(std::abs(pivot) > kLeastPivot * largest)) return false;
    inverse_.push_back(1.0 / pivot);
    for (auto at = row.upper_bound(own); at != row.end(); ++at) {
      const Complex u = at->second * inverse_[i];
      upper_.entries.push_back({at->first, u.real(), u.imag()});
    }
    lower_.end_row();
    upper_.end_row();
  }
  return true;
}

/// Reorders the buses by their height in the elimination tree. Buses of equal height are independent, so that
/// the processor can overlap their operations.
void BusFactors::by_height() {
  const std::size_t n = order_.size();
  std::vector<int> height(n, 0), sorted(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = upper_.first[i]; k < upper_.first[i + 1]; ++k) {
      int& above = height[static_cast<std::size_t>(upper_.entries[k].column)];
      above = std::max(above, height[i] + 1);
    }
  std::iota(sorted.begin(), sorted.end(), 0);
  std::ranges::stable_sort(sorted, {}, [&](int k) { return height[static_cast<std::size_t>(k)]; });
  std::vector<int> order;
  for (const int k : sorted) order.push_back(order_[static_cast<std::size_t>(k)]);
  order_ = std::move(order);
}

}  // namespace swingbank::sim::batch
