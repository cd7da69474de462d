#pragma once
// How far a training run is: one line that renews itself on a terminal, a log line every so often elsewhere.
#include <chrono>
#include <cstdint>
#include <string>

namespace swingbank::train::loop {

class TrainingProgress {
 public:
  /// total: samples of all epochs; title starts each line. Writes to standard error.
  TrainingProgress(std::string title, std::uint64_t total, bool quiet = false);
  /// done: samples so far, those before a resume included; note: what the epoch says of itself.
  void update(std::uint64_t done, const std::string& note);
  /// A line of its own, whatever the medium.
  void line(const std::string& text);

 private:
  using Clock = std::chrono::steady_clock;
  std::string title_;
  std::uint64_t total_, first_ = 0;
  bool started_ = false, terminal_, quiet_, open_line_ = false;
  Clock::time_point begin_, last_;
};

/// "1 h 02 min", "3 min 20 s", "12 s".
std::string duration(double seconds);

}  // namespace swingbank::train::loop
