#pragma once
// Complex number type of phasors, impedances and powers.
#include <complex>

namespace swingbank {

using Complex = std::complex<double>;

}  // namespace swingbank
