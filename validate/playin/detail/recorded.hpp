#pragma once
// Inputs of the recorded machine (component.hpp): its parameters contain the values at the operating point,
// and its scratch memory the changes since then.
#include <vector>

namespace swingbank::validate::playin::recorded {

enum Parameter { Efd, Tm, Ifd0, kParameters };  ///< at the operating point [pu on the machine's base]
enum Coefficient { Ifd, kCoefficients };
enum Move { speed, dIfd, Vs, kMoves };  ///< changes since the operating point [pu]

template <class T>
std::vector<T> operating_parameters(const T& efd, const T& ifd, const T& tm) {
  std::vector<T> p(kParameters);
  p[Efd] = efd;
  p[Tm] = tm;
  p[Ifd0] = ifd;
  return p;
}

}  // namespace swingbank::validate::playin::recorded
