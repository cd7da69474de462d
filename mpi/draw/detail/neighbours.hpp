#pragma once
// Whether another point lies within a distance. Points are sorted into cells of the distance's size along the
// few axes that are much longer than it; 60,000 GENROU points at 0.7 then need some hundred comparisons per
// candidate, eight at a time.
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace swingbank::mpi::draw {

class Neighbours {
 public:
  /// Boxes' low ends and widths per axis, in the units distances are measured in.
  Neighbours(std::vector<double> low, std::vector<double> width, double distance);
  /// x: a value per axis. True if a point lies closer than the distance.
  [[nodiscard]] bool near(const double* x) const;
  void add(const double* x);
  void clear() { cells_.clear(); }

 private:
  /// Points of a cell in blocks of eight: the first axis of all eight, then the second; the last block is
  /// filled up with points that are infinitely far away.
  struct Cell {
    std::size_t points = 0;
    std::vector<double> blocks;
  };
  /// Axes in order_, as all below have them.
  [[nodiscard]] std::vector<double> ordered(const double* x) const;
  [[nodiscard]] std::uint64_t cell(const double* x, std::size_t axis) const;
  [[nodiscard]] bool near_in(std::uint64_t key, const double* x) const;
  /// `gap`: square of the way to the cell so far, in distances.
  [[nodiscard]] bool near_along(std::size_t axis, std::uint64_t key, const double* x, double gap) const;

  std::vector<double> low_;
  double distance_;
  std::vector<std::size_t> order_;  ///< axes, longest first
  std::size_t gridded_;             ///< how many of them make up a cell
  std::unordered_map<std::uint64_t, Cell> cells_;
};

}  // namespace swingbank::mpi::draw
