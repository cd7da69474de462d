#pragma once
// The averaging windows that phasor measurement units are known to have.
#include <vector>

namespace swingbank::validate::event {

/// An averaging window: even, its integral 1.
class FilterWindow {
 public:
  enum class Shape { triangle, box, class_m };
  FilterWindow() = default;
  FilterWindow(Shape shape, double half, double Ffr = 0);
  [[nodiscard]] Shape shape() const { return shape_; }
  /// How far the window reaches to either side [s]; 0: no window.
  [[nodiscard]] double half() const { return half_; }
  /// Density [1/s] at `t` [s] from the middle.
  [[nodiscard]] double operator()(double t) const;

 private:
  [[nodiscard]] double form(double t) const;
  Shape shape_ = Shape::triangle;
  double half_ = 0, Ffr_ = 0, scale_ = 0;
};

/// The windows worth trying at a frequency [Hz] and a rate of reports [1/s]: triangles and boxes of half a
/// cycle to two to either side, and the reference filters of class M for these reports, and for twice as
/// many, of which every second was kept.
std::vector<FilterWindow> known_windows(double frequency, double rate);

}  // namespace swingbank::validate::event
