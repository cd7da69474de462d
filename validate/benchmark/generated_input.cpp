#include "validate/benchmark/generated_input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.hpp"

namespace swingbank::validate::benchmark {

record::Record generated_input(const Test& test, const InitialPoint& initial,
                               const plant::PlantModel& model) {
  record::Record r;
  r.name = test.name;
  r.format = "generated";
  r.base = model.record_base;
  const double end = test.end.value_or(std::numeric_limits<double>::infinity()), size = *test.size;
  const double share = model.plant.mva / r.base.mva;
  const auto samples = static_cast<long>(std::floor(test.post->second * initial.rate + 1e-6)) + 1;
  for (long k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) / initial.rate;
    // A sample at a switching time has the value before the switching.
    const bool on = t > test.event && t <= end;
    const double since = std::max(0.0, std::min(t, end) - test.event), after = std::max(0.0, t - end);
    double V = initial.V, theta = 0;
    switch (test.kind) {
      case TestKind::voltage_dip:
      case TestKind::voltage_swell:
      case TestKind::voltage_step:
        V += on ? size : 0.0;
        break;
      case TestKind::frequency_step:
        theta = constants::turn * size * since;
        break;
      case TestKind::frequency_ramp:
        theta = constants::turn * size * (since * since / 2 + since * after);
        break;
      case TestKind::phase_step:
        theta = on ? size / constants::degrees_in_radian : 0.0;
        break;
      default:  // a reference step
        break;
    }
    r.t.push_back(t);
    r.V.push_back(V);
    r.theta.push_back(theta);
    r.P.push_back(initial.P * share);
    r.Q.push_back(initial.Q * share);
  }
  return r;
}

}  // namespace swingbank::validate::benchmark
