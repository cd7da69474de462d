#include "train/loop/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace swingbank::train::loop {

TrainingProgress::TrainingProgress(std::string title, std::uint64_t total, bool quiet)
    : title_(std::move(title)), total_(total), terminal_(isatty(STDERR_FILENO) != 0), quiet_(quiet) {}

void TrainingProgress::update(std::uint64_t done, const std::string& note) {
  const auto now = Clock::now();
  if (!started_) {  // the rate excludes samples before a resume
    started_ = true;
    first_ = done;
    begin_ = last_ = now;
    return;
  }
  const double since_last = std::chrono::duration<double>(now - last_).count();
  if (quiet_ || (since_last < (terminal_ ? 0.5 : 30.0))) return;
  last_ = now;
  const double seconds = std::chrono::duration<double>(now - begin_).count();
  const double rate = static_cast<double>(done - first_) / seconds;
  const double left = rate > 0.0 ? static_cast<double>(total_ - std::min(done, total_)) / rate : 0.0;
  const std::string text = fmt::format(
      "{}: {} of {} samples ({:.0f} %), {:.0f} samples/s, at most {} left, {}", title_, done, total_,
      100.0 * static_cast<double>(done) / static_cast<double>(total_), rate, duration(left), note);
  if (terminal_)
    fmt::print(stderr, "\r\033[K{}", text);
  else
    fmt::print(stderr, "{}\n", text);
  open_line_ = terminal_;
  std::fflush(stderr);
}

TrainingProgress::~TrainingProgress() { clear_line(); }

void TrainingProgress::clear_line() {
  if (open_line_) std::fputs("\r\033[K", stderr);
  open_line_ = false;
}

/// Removes the status line and the chart from the terminal.
void TrainingProgress::clear() {
  clear_line();
  if (chart_lines_ > 0) fmt::print(stderr, "\033[{}A\033[J", chart_lines_);
  chart_lines_ = 0;
}

void TrainingProgress::line(const std::string& text) {
  if (quiet_) return;
  clear();
  fmt::print(stderr, "{}: {}\n", title_, text);
}

void TrainingProgress::chart(const std::string& text) {
  if (quiet_ || !terminal_) return;
  clear();
  fmt::print(stderr, "{}", text);
  chart_lines_ = std::ranges::count(text, '\n');
}

std::string duration(double seconds) {
  const auto s = static_cast<std::int64_t>(seconds + 0.5);
  if (s >= 3600) return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
  if (s >= 60) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} s", s);
}

}  // namespace swingbank::train::loop
