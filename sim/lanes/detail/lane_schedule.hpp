#pragma once
// Time of one lane: its segments, its step and the rules by which the step grows and shrinks.
#include <vector>

#include "sim/lanes/batch.hpp"
#include "sim/network/event.hpp"
#include "sim/plant/tableau.hpp"

namespace swingbank::sim::lanes {

/// Step size control of a lane: proportional-integral (Hairer & Wanner II, IV.2), order 5.
struct LaneClock {
  double t = 0.0;     ///< [s]
  double h = 0.0;     ///< step the controller asks for [s]
  double next = 0.0;  ///< next instant the step must not cross: a switching or the end [s]
  float last_error = 1.0F;
  static constexpr double kFirstStep = 0.006, kLongestStep = 0.25, kShortestStep = 1e-9;

  void restart(double next_switch) {
    h = kFirstStep;
    last_error = 1.0F;
    next = next_switch;
  }
  /// The step to try now: the rest of the segment at once, or halved so that no sliver remains.
  [[nodiscard]] double step(bool& reaches) const {
    const double rest = next - t;
    reaches = h >= 0.999 * rest;
    if (reaches) return rest;
    return h > 0.55 * rest ? 0.5 * rest : h;
  }
  /// Adapts to the scaled error of the step just tried; true if it is accepted.
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

/// One lane's run: the job, where it is in its segments, and its record.
struct LaneRun {
  Job job;
  std::vector<network::Segment> segments;
  std::vector<double> jumps;  ///< instants at which the plants' effects jump, sorted [s]
  std::size_t segment = 0;
  int recorded = 0;                                   ///< samples in the record
  int pending = 0;                                    ///< samples whose states wait to be evaluated
  std::vector<double, CacheAligned<double>> waiting;  ///< their states, [samples of a pack][state][sample]
  std::vector<double> theta;  ///< last terminal angle per recorded plant, held while V = 0 [rad]
  std::vector<int> islands;   ///< per plant, where the segment has several; else empty
  LaneClock clock;
  Trajectory record;
};

}  // namespace swingbank::sim::lanes
