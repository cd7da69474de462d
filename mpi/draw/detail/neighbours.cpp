#include "mpi/draw/detail/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace swingbank::mpi::draw {

namespace {
constexpr std::size_t kAxes = 4;     ///< gridded at most: 3^4 cells are visited
constexpr double kWorthwhile = 3.0;  ///< an axis shorter than this many distances does not separate
constexpr unsigned kBits = 16;       ///< of a cell number per axis
}  // namespace

Neighbours::Neighbours(std::vector<double> low, std::vector<double> width, double distance)
    : low_(std::move(low)), distance_(distance), order_(width.size()), gridded_(0) {
  std::iota(order_.begin(), order_.end(), 0);
  std::ranges::stable_sort(order_, [&](std::size_t a, std::size_t b) { return width[a] > width[b]; });
  while (gridded_ < std::min(kAxes, order_.size()) && width[order_[gridded_]] >= kWorthwhile * distance)
    ++gridded_;
}

/// Cell numbers start at 1, so that the neighbour below the first has a number too.
std::uint64_t Neighbours::cell(const double* x, std::size_t axis) const {
  const std::size_t a = order_[axis];
  return 1 + static_cast<std::uint64_t>(std::min((x[a] - low_[a]) / distance_, 60000.0));
}

bool Neighbours::near_in(std::uint64_t key, const double* x) const {
  const auto found = cells_.find(key);
  if (found == cells_.end()) return false;
  const double limit = distance_ * distance_;
  const std::size_t n = order_.size();
  for (const double *p = found->second.data(), *end = p + found->second.size(); p != end; p += n) {
    double sum = 0.0;
    for (std::size_t i = 0; i < n && sum < limit; ++i) sum += (p[i] - x[order_[i]]) * (p[i] - x[order_[i]]);
    if (sum < limit) return true;
  }
  return false;
}

bool Neighbours::near_along(std::size_t axis, std::uint64_t key, const double* x, double gap) const {
  if (axis == gridded_) return near_in(key, x);
  constexpr double reach = 1.0 + 1e-9;  // cells farther off than the distance hold no neighbour
  const std::uint64_t c = cell(x, axis);
  const std::size_t a = order_[axis];
  const double below = (x[a] - low_[a]) / distance_ - static_cast<double>(c - 1), above = 1.0 - below;
  if (near_along(axis + 1, (key << kBits) | c, x, gap)) return true;
  if (const double far = gap + below * below; far < reach)
    if (near_along(axis + 1, (key << kBits) | (c - 1), x, far)) return true;
  const double far = gap + above * std::max(above, 0.0);
  return far < reach && near_along(axis + 1, (key << kBits) | (c + 1), x, far);
}

bool Neighbours::near(const double* x) const { return near_along(0, 0, x, 0.0); }

void Neighbours::add(const double* x) {
  std::uint64_t key = 0;
  for (std::size_t axis = 0; axis < gridded_; ++axis) key = (key << kBits) | cell(x, axis);
  auto& points = cells_[key];
  for (const std::size_t a : order_) points.push_back(x[a]);
}

}  // namespace swingbank::mpi::draw
