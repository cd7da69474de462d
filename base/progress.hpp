#pragma once
// Progress display of a long run: fraction completed, rate and remaining time, as one updated line on a
// terminal and as log lines elsewhere.
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace swingbank {

/// Progress counter that prints to standard error: a bar at most every 0.2 s, or lines at most every 5 s.
class Progress {
 public:
  /// Form of the output; automatic: a bar on a terminal, otherwise lines.
  enum class Mode { automatic, bar, lines, none };
  /// Returns the values of --progress, in the order of Mode.
  static const std::vector<std::string>& words();
  /// `unit`: name of the items, such as "draws"; `total`: number of items; `done`: items that earlier runs
  /// have completed.
  Progress(Mode mode, std::string unit, std::uint64_t total, std::uint64_t done);
  ~Progress() { finish(); }
  /// Counts `count` more items; prints if the last output is old enough.
  void add(std::uint64_t count);
  /// Completes the bar with its last state and a line feed. The destructor calls it.
  void finish();
  /// Returns the time since construction [s].
  [[nodiscard]] double seconds() const;
  [[nodiscard]] double rate() const;  ///< items of this run per second [1/s]

 private:
  using Clock = std::chrono::steady_clock;
  void print(bool last);
  Mode mode_;
  std::string unit_;
  std::uint64_t total_, before_, done_;
  Clock::time_point start_ = Clock::now(), printed_ = Clock::now();
  bool open_ = false;  ///< whether the terminal's last line lacks its line feed
};

/// Returns a rate as "120 draws/s", below 1/s as "4.5 plants/min" or "2.0 plants/h".
std::string rate_text(double per_second, const std::string& unit);
/// Returns a duration as "1 h 02 min", "3 min 20 s" or "12 s".
std::string duration_text(double seconds);

}  // namespace swingbank
