#pragma once
// Progress of a training run: one line that is rewritten on a terminal, periodic log lines otherwise.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

namespace swingbank::train::loop {

class TrainingProgress {
 public:
  /// total: samples of all epochs; title: start of each line. Writes to standard error.
  TrainingProgress(std::string title, std::uint64_t total, bool quiet = false);
  TrainingProgress(const TrainingProgress&) = delete;
  TrainingProgress& operator=(const TrainingProgress&) = delete;
  /// Removes the status line from the terminal; a chart stays.
  ~TrainingProgress();
  /// done: samples so far, including those before a resume; note: text about the epoch.
  void update(std::uint64_t done, const std::string& note);
  /// Prints a separate line, on a terminal or in a log.
  void line(const std::string& text);
  /// Shows a chart below the lines printed so far, in place of the previous chart. Only on a terminal.
  void chart(const std::string& text);
  /// Leaves the shown chart on the terminal; later lines follow it.
  void keep_chart() { chart_lines_ = 0; }

 private:
  using Clock = std::chrono::steady_clock;
  std::string title_;
  std::uint64_t total_, first_ = 0;
  bool started_ = false, terminal_, quiet_, open_line_ = false;
  std::ptrdiff_t chart_lines_ = 0;  ///< number of lines of the shown chart

  void clear_line();
  void clear();
  Clock::time_point begin_, last_;
};

/// Returns "1 h 02 min", "3 min 20 s" or "12 s".
std::string duration(double seconds);

}  // namespace swingbank::train::loop
