#pragma once
// Golden-section search: minimum of a function of one variable between two bounds that enclose it.
namespace swingbank {

/// Minimiser and minimum of a function.
struct Minimum {
  double at = 0, value = 0;  ///< minimiser and minimum
};

/// Computes a local minimum of `f` in [low, high] by golden-section search. Each step shortens the interval
/// by 38 %. Continues while more(number of steps, width of the interval) returns true.
template <class F, class More>
Minimum golden_section(const F& f, double low, double high, const More& more) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = f(a), at_b = f(b);
  for (int step = 0; more(step, high - low); ++step) {
    if (at_a < at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = f(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = f(b);
    }
  }
  return at_a < at_b ? Minimum{a, at_a} : Minimum{b, at_b};
}

}  // namespace swingbank
