#pragma once
// SUNDIALS vectors compiled with this build's instruction set. Debian's vectors are compiled for the baseline
// processor, without fused operations, and took half of a run's time.
#include <sundials/sundials_nvector.h>

namespace swingbank::sim::reference {

/// Returns a serial vector with the norm max |x_i| w_i instead of the weighted root mean square. The
/// tolerance then applies to each unknown, whatever the grid's size (decision 05). Free with N_VDestroy.
N_Vector new_vector(sunindextype length, SUNContext context);

}  // namespace swingbank::sim::reference
