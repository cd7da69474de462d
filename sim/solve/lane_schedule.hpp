#pragma once
// Time of one lane: its segments, its step and the rules by which the step grows and shrinks.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "sim/network/event.hpp"
#include "sim/solve/batch.hpp"

namespace swingbank::sim {

/// x^p for the step controller only: relative error below 6 %, the same bits on every machine.
inline float rough_power(float x, float p) {
  const float log2 = static_cast<float>(std::bit_cast<std::int32_t>(x)) * 1.1920929e-7F - 126.94269504F;
  return std::bit_cast<float>(static_cast<std::int32_t>((log2 * p + 126.94269504F) * 8388608.0F));
}

/// Step size control of a lane: proportional-integral (Hairer & Wanner II, IV.2), order 5.
struct LaneClock {
  double t = 0.0;         ///< [s]
  double h = 0.0;         ///< step the controller asks for [s]
  double next = 0.0;      ///< next instant the step must not cross: a switching or the end [s]
  float last_error = 1.0F;
  static constexpr double kFirst = 0.006, kLongest = 0.25, kShortest = 1e-9;

  void restart(double next_switch) {
    h = kFirst;
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
      float f = 0.9F * rough_power(e, -0.14F) * rough_power(last_error, 0.06F);
      f = f > 4.0F ? 4.0F : (f < 0.3F ? 0.3F : f);
      const double grown = tried * f;
      const bool cut_short = tried < 0.999 * h;
      h = cut_short && grown < h ? h : grown;
      if (h > kLongest) h = kLongest;
      last_error = e < 1e-3F ? 1e-3F : e;
    } else {
      const float f = 0.85F * rough_power(e, -0.2F);
      h = tried * (f < 0.2F ? 0.2F : f);
    }
    return ok;
  }
};

/// Samples on their way into a record. Channels lie far apart there; collecting eight samples per visit writes whole
/// cache lines and touches each page an eighth as often (2.4 x faster with ten generators recorded).
class SampleStage {
 public:
  void begin(int rows) {
    rows_ = rows;
    count_ = first_ = 0;
    values_.resize(static_cast<std::size_t>(rows) * kDepth);
  }
  /// Appends one sample: row i is v[i * stride].
  void put(const double* v, int stride, Trajectory& record) {
    double* to = values_.data() + count_ * rows_;
    for (int i = 0; i < rows_; ++i) to[i] = v[i * stride];
    if (++count_ == kDepth) flush(record);
  }
  void flush(Trajectory& record) {
    for (int i = 0; i < rows_; ++i) {
      double* to = record.values.data() + static_cast<std::ptrdiff_t>(i) * record.samples + first_;
      const double* from = values_.data() + i;
      for (int k = 0; k < count_; ++k) to[k] = from[k * rows_];
    }
    first_ += count_;
    count_ = 0;
  }
  /// Repeats the last sample until `until` samples are recorded.
  void hold(int until, Trajectory& record) {
    flush(record);
    if (first_ == 0) return;
    for (int i = 0; i < rows_ && first_ < until; ++i) {
      double* v = record.values.data() + static_cast<std::ptrdiff_t>(i) * record.samples;
      std::fill(v + first_, v + until, v[first_ - 1]);
    }
    first_ = std::max(first_, until);
  }
  [[nodiscard]] int recorded() const { return first_ + count_; }

 private:
  static constexpr int kDepth = 8;
  int rows_ = 0, count_ = 0, first_ = 0;
  std::vector<double> values_;  ///< [sample][row]
};

/// One lane's run: the job, where it is in its segments, and its record.
struct LaneRun {
  Job job;
  std::vector<Segment> segments;
  std::size_t segment = 0;
  SampleStage stage;
  LaneClock clock;
  Trajectory record;
};

}  // namespace swingbank::sim
