#include "validate/switching/filter_window.hpp"

#include <cmath>

#include "sim/core/pmu_window.hpp"

namespace swingbank::validate::switching {
namespace pmu = sim::pmu_window;

FilterWindow::FilterWindow(Shape shape, double half, double Ffr) : shape_(shape), half_(half), Ffr_(Ffr) {
  constexpr int kNodes = 2000;
  double sum = 0;
  for (int i = 0; i < kNodes; ++i) sum += form(half * (2.0 * (i + 0.5) / kNodes - 1));
  scale_ = kNodes / (2 * half * sum);
}

double FilterWindow::form(double t) const {
  switch (shape_) {
    case Shape::triangle:
      return pmu::class_p(t, half_);
    case Shape::box:
      return 1;
    case Shape::class_m:
      break;
  }
  return pmu::class_m(t, half_, Ffr_);
}

double FilterWindow::operator()(double t) const { return std::abs(t) < half_ ? scale_ * form(t) : 0.0; }

std::vector<FilterWindow> known_windows(double frequency, double rate) {
  std::vector<FilterWindow> windows;
  for (const auto shape : {FilterWindow::Shape::triangle, FilterWindow::Shape::box})
    for (const double cycles : {0.5, 0.75, 1.0, 1.25, 1.5, 2.0})
      windows.emplace_back(shape, cycles / frequency);
  for (const double reports : {rate, 2 * rate})
    if (const pmu::MClass* row = pmu::find(frequency, std::round(reports)))
      windows.emplace_back(FilterWindow::Shape::class_m, row->half(frequency), row->Ffr);
  return windows;
}

}  // namespace swingbank::validate::switching
