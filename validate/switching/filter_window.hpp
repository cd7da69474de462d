#pragma once
// Averaging windows of phasor measurement units.
#include <vector>

namespace swingbank::validate::switching {

/// Averaging window: a symmetric weight function with integral 1.
class FilterWindow {
 public:
  /// Form of the weight function; class_m: the class M reference filter of IEEE C37.118.1.
  enum class Shape { triangle, box, class_m };
  FilterWindow() = default;
  /// Makes a window of half-width `half` [s]. `Ffr`: cut-off frequency of a class M filter [Hz].
  FilterWindow(Shape shape, double half, double Ffr = 0);
  /// Returns the form.
  [[nodiscard]] Shape shape() const { return shape_; }
  /// Returns the half-width of the window [s]; 0: no window.
  [[nodiscard]] double half() const { return half_; }
  /// Returns the weight [1/s] at `t` [s] from the middle.
  [[nodiscard]] double operator()(double t) const;

 private:
  [[nodiscard]] double form(double t) const;
  Shape shape_ = Shape::triangle;
  double half_ = 0, Ffr_ = 0, scale_ = 0;
};

/// Returns the candidate windows at a frequency [Hz] and a reporting rate [1/s]. They are triangles and boxes
/// with half-widths of 0.5 to 2 cycles, and the class M reference filters for this rate and for twice this
/// rate. The filter for twice the rate applies if every second report was dropped.
std::vector<FilterWindow> known_windows(double frequency, double rate);

}  // namespace swingbank::validate::switching
