#pragma once
// Result of a simulation, common to all integrators.
#include <cstddef>
#include <new>
#include <string_view>
#include <vector>

#include "sim/core/channel.hpp"

namespace swingbank::sim {

/// End of a simulation: t_end reached, synchronism lost, a state not finite, or the step size below its
/// minimum.
enum class Outcome { stable, lost_synchronism, not_finite, step_too_small };
/// Returns the name in reports and datasets, "lost_synchronism".
constexpr std::string_view outcome_name(Outcome o) {
  constexpr std::string_view names[] = {"stable", "lost_synchronism", "not_finite", "step_too_small"};
  return names[static_cast<int>(o)];
}

/// Allocator that aligns memory to cache lines, so that a pack of eight samples fills one line exactly.
template <class T>
struct CacheAligned {
  using value_type = T;                         ///< element type, as the allocator requirements demand
  static constexpr std::align_val_t kLine{64};  ///< cache line [bytes]
  CacheAligned() = default;
  /// Converts from the allocator of another element type; allocators have no state.
  template <class U>
  CacheAligned(const CacheAligned<U>&) {
  }  // NOLINT(google-explicit-constructor): required by the allocator protocol
  /// Allocates memory for n elements, aligned to a cache line.
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kLine)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kLine); }  ///< releases memory from allocate()
  /// All allocators are equal.
  friend bool operator==(const CacheAligned&, const CacheAligned&) { return true; }
};

/// Samples at t = k/rate, k = 0..samples-1. At a switching time the sample is the value just before it,
/// unless the integrator's options request the value after it.
struct Trajectory {
  double rate = 0.0;              ///< samples per second [1/s]
  int samples = 0;                ///< number of samples of each row
  int stride = 0;                 ///< distance between rows of `values`, at least `samples`
  std::vector<int> plants;        ///< indices of the recorded plants in the grid
  std::vector<Channel> channels;  ///< recorded channels, the same for each plant
  std::vector<double, CacheAligned<double>> values;  ///< rows [plant][channel], see at() and packed()
  Outcome outcome = Outcome::stable;                 ///< how the simulation ended
  double stopped_at = 0.0;      ///< end of the simulation [s]: t_end, or the time of an early end
  double largest_spread = 0.0;  ///< maximum change of the angle between two rotors since the start [rad]

  /// Returns the number of rows, plants times channels.
  [[nodiscard]] int rows() const { return static_cast<int>(plants.size() * channels.size()); }
  /// Allocates every row. With `whole_lines` each row starts on a cache line.
  void allocate(bool whole_lines) {
    constexpr int kDoublesPerLine = 8;
    stride = whole_lines ? (samples + kDoublesPerLine - 1) / kDoublesPerLine * kDoublesPerLine : samples;
    values.resize(static_cast<std::size_t>(rows()) * static_cast<std::size_t>(stride));
  }
  /// Returns row i = plant * channels + channel: `samples` values in the channel's unit.
  [[nodiscard]] double* row(int i) { return values.data() + static_cast<std::ptrdiff_t>(i) * stride; }
  /// The same, read only.
  [[nodiscard]] const double* row(int i) const {
    return values.data() + static_cast<std::ptrdiff_t>(i) * stride;
  }
  /// Returns the samples of one channel of one plant. The arguments are indices into `plants` and `channels`.
  [[nodiscard]] double* at(int plant, int channel) {
    return row(plant * static_cast<int>(channels.size()) + channel);
  }
  /// The same, read only.
  [[nodiscard]] const double* at(int plant, int channel) const {
    return row(plant * static_cast<int>(channels.size()) + channel);
  }
  /// Returns the values as [plant][channel][sample] without gaps.
  [[nodiscard]] std::vector<double> packed() const {
    std::vector<double> all;
    all.reserve(static_cast<std::size_t>(rows()) * static_cast<std::size_t>(samples));
    for (int i = 0; i < rows(); ++i) all.insert(all.end(), row(i), row(i) + samples);
    return all;
  }
};

}  // namespace swingbank::sim
