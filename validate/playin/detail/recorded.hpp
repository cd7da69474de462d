#pragma once
// Inputs of the recorded machine: values at the operating point in its parameters, later changes in its
// scratch memory.
#include <vector>

namespace swingbank::validate::playin::recorded {

enum Parameter { Efd, Tm, Ifd0, kParameters };  ///< at the operating point [pu on the machine's base]
enum Coefficient { Ifd, kCoefficients };
enum Move { speed, dIfd, Vs, kMoves };  ///< since the operating point [pu]

template <class T>
std::vector<T> operating_parameters(const T& efd, const T& ifd, const T& tm) {
  std::vector<T> p(kParameters);
  p[Efd] = efd;
  p[Tm] = tm;
  p[Ifd0] = ifd;
  return p;
}

}  // namespace swingbank::validate::playin::recorded
