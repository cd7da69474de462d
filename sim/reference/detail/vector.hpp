#pragma once
// Vectors for SUNDIALS with this build's instruction set. Debian's are compiled for the oldest processor and
// without fused operations, and took half of a run's time.
#include <sundials/sundials_nvector.h>

namespace swingbank::sim::reference {

/// A serial vector whose norm is the largest |x_i| w_i in place of the weighted root mean square: one run
/// keeps its tolerance for every single unknown, however large the grid (decision 05). Free with N_VDestroy.
N_Vector new_vector(sunindextype length, SUNContext context);

}  // namespace swingbank::sim::reference
