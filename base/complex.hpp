#pragma once
// Phasors, impedances and powers.
#include <complex>

namespace swingbank {

using Complex = std::complex<double>;

}  // namespace swingbank
