#pragma once
// Complex number type of phasors, impedances and powers.
#include <complex>

namespace swingbank {

/// Complex number, for phasors, powers and impedances.
using Complex = std::complex<double>;

}  // namespace swingbank
