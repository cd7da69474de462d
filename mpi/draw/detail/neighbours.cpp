#include "mpi/draw/detail/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/core/pack.hpp"

namespace swingbank::mpi::draw {

namespace {
constexpr std::size_t kAxes = 4;     ///< largest number of gridded axes; a search visits up to 3^4 cells
constexpr double kWorthwhile = 3.0;  ///< minimum width of a gridded axis, as a multiple of the distance
constexpr unsigned kBits = 16;       ///< bits of a cell number per axis
constexpr int kPointsAtOnce = 8;     ///< points per block
constexpr std::size_t kEarlyTestAxes = 4;  ///< number of axes before a block's test for early rejection
using Block = sim::Pack<kPointsAtOnce>;

bool any_below(Block sums, double limit) { return any_positive(Block(limit) - sums); }
}  // namespace

Neighbours::Neighbours(std::vector<double> low, std::vector<double> width, double distance)
    : low_(std::move(low)), distance_(distance), order_(width.size()), gridded_(0) {
  std::iota(order_.begin(), order_.end(), 0);
  std::ranges::stable_sort(order_, [&](std::size_t a, std::size_t b) { return width[a] > width[b]; });
  while (gridded_ < std::min(kAxes, order_.size()) && width[order_[gridded_]] >= kWorthwhile * distance)
    ++gridded_;
}

std::vector<double> Neighbours::ordered(const double* x) const {
  std::vector<double> y(order_.size());
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = x[order_[i]];
  return y;
}

/// Returns the cell number on an axis. Numbers start at 1, so that the cell below the first also has a
/// number.
std::uint64_t Neighbours::cell(const double* x, std::size_t axis) const {
  return 1 + static_cast<std::uint64_t>(std::min((x[axis] - low_[order_[axis]]) / distance_, 60000.0));
}

bool Neighbours::near_in(std::uint64_t key, const double* x) const {
  const auto found = cells_.find(key);
  if (found == cells_.end()) return false;
  const double limit = distance_ * distance_;
  const std::size_t n = order_.size();
  const std::vector<double>& blocks = found->second.blocks;
  for (const double *p = blocks.data(), *end = p + blocks.size(); p != end; p += n * kPointsAtOnce) {
    Block sums(0.0);
    for (std::size_t i = 0; i < n; ++i) {
      const Block d = Block::load(p + i * kPointsAtOnce) - Block(x[i]);
      sums = sums + d * d;
      if (i + 1 == kEarlyTestAxes && !any_below(sums, limit)) break;
    }
    if (any_below(sums, limit)) return true;
  }
  return false;
}

bool Neighbours::near_along(std::size_t axis, std::uint64_t key, const double* x, double gap) const {
  if (axis == gridded_) return near_in(key, x);
  constexpr double reach = 1.0 + 1e-9;  // cells beyond the distance contain no neighbour
  const std::uint64_t c = cell(x, axis);
  const double below = (x[axis] - low_[order_[axis]]) / distance_ - static_cast<double>(c - 1),
               above = 1.0 - below;
  if (near_along(axis + 1, (key << kBits) | c, x, gap)) return true;
  if (const double far = gap + below * below; far < reach)
    if (near_along(axis + 1, (key << kBits) | (c - 1), x, far)) return true;
  const double far = gap + above * std::max(above, 0.0);
  return far < reach && near_along(axis + 1, (key << kBits) | (c + 1), x, far);
}

bool Neighbours::near(const double* x) const { return near_along(0, 0, ordered(x).data(), 0.0); }

void Neighbours::add(const double* x) {
  const std::vector<double> y = ordered(x);
  std::uint64_t key = 0;
  for (std::size_t axis = 0; axis < gridded_; ++axis) key = (key << kBits) | cell(y.data(), axis);
  Cell& c = cells_[key];
  const std::size_t slot = c.points++ % kPointsAtOnce, n = y.size();
  if (slot == 0)
    c.blocks.resize(c.blocks.size() + n * kPointsAtOnce, std::numeric_limits<double>::infinity());
  double* block = c.blocks.data() + c.blocks.size() - n * kPointsAtOnce;
  for (std::size_t i = 0; i < n; ++i) block[i * kPointsAtOnce + slot] = y[i];
}

}  // namespace swingbank::mpi::draw
