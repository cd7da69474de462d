#pragma once
// Time and step size control of one lane.
#include <vector>

#include "sim/batch/batch.hpp"
#include "sim/network/event.hpp"
#include "sim/plant/tableau.hpp"

namespace swingbank::sim::batch {

/// Step size control of a lane: proportional-integral (Hairer & Wanner II, IV.2), order 5.
struct LaneClock {
  double t = 0.0;     ///< present time [s]
  double h = 0.0;     ///< step size requested by the controller [s]
  double next = 0.0;  ///< next time that a step must not cross: a switching time or the end [s]
  float last_error = 1.0F;
  static constexpr double kFirstStep = 0.006, kLongestStep = 0.25, kShortestStep = 1e-9;

  void restart(double next_switch) {
    h = kFirstStep;
    last_error = 1.0F;
    next = next_switch;
  }
  /// Returns the step size to try [s]: h, or the rest of the segment, or half of the rest to avoid a tiny
  /// last step. Sets `reaches` if the step ends the segment.
  [[nodiscard]] double step(bool& reaches) const {
    const double rest = next - t;
    reaches = h >= 0.999 * rest;
    if (reaches) return rest;
    return h > 0.55 * rest ? 0.5 * rest : h;
  }
  /// Adapts the step size to the scaled error of the step `tried` [s]. Returns true if the step is accepted.
  bool judge(double tried, double scaled_error) {
    const bool ok = scaled_error <= 1.0;
    float e = static_cast<float>(scaled_error);
    if (!(e < 1e30F)) e = 1e30F;
    if (e < 1e-8F) e = 1e-8F;
    if (ok) {
      float f = 0.9F * plant::dp54::rough_power(e, -0.14F) * plant::dp54::rough_power(last_error, 0.06F);
      f = f > 4.0F ? 4.0F : (f < 0.3F ? 0.3F : f);
      const double grown = tried * f;
      const bool cut_short = tried < 0.999 * h;
      h = cut_short && grown < h ? h : grown;
      if (h > kLongestStep) h = kLongestStep;
      last_error = e < 1e-3F ? 1e-3F : e;
    } else {
      const float f = 0.85F * plant::dp54::rough_power(e, -0.2F);
      h = tried * (f < 0.2F ? 0.2F : f);
    }
    return ok;
  }
};

/// State of one lane's run: the job, its segments and its record.
struct BatchRun {
  Job job;
  std::vector<network::Segment> segments;
  std::vector<double> discontinuities;  ///< sorted times at which the plants' effects are discontinuous [s]
  std::size_t segment = 0;
  int recorded = 0;  ///< number of samples in the record
  int pending = 0;   ///< number of buffered samples, not yet evaluated
  std::vector<double, CacheAligned<double>>
      waiting;                ///< states of the buffered samples, [pack][state][sample]
  std::vector<double> theta;  ///< last terminal angle per recorded plant, kept while V = 0 [rad]
  std::vector<int> islands;   ///< island number per plant; empty if all plants are in one island
  LaneClock clock;
  Trajectory record;
};

}  // namespace swingbank::sim::batch
