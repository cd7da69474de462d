#pragma once
// How far a run is, with its rate and the time it still needs: one line in place on a terminal, log lines
// elsewhere.
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace swingbank {

class Progress {
 public:
  enum class Mode { automatic, bar, lines, none };
  /// Of --progress, in the order of Mode.
  static const std::vector<std::string>& words();
  /// `done`: what earlier runs have made. `unit`: "draws".
  Progress(Mode mode, std::string unit, std::uint64_t total, std::uint64_t done);
  ~Progress() { finish(); }
  /// Notes `count` more; prints if it is time.
  void add(std::uint64_t count);
  void finish();
  [[nodiscard]] double seconds() const;
  [[nodiscard]] double rate() const;  ///< of this run [1/s]

 private:
  using Clock = std::chrono::steady_clock;
  void print(bool last);
  Mode mode_;
  std::string unit_;
  std::uint64_t total_, before_, done_;
  Clock::time_point start_ = Clock::now(), printed_ = Clock::now();
  bool open_ = false;  ///< a line without its line feed stands on the terminal
};

/// "120 draws/s", and where that would be below one "4.5 plants/min" or "2.0 plants/h".
std::string rate_text(double per_second, const std::string& unit);
/// "1 h 02 min", "3 min 20 s", "12 s".
std::string duration_text(double seconds);

}  // namespace swingbank
