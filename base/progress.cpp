#include "base/progress.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace swingbank {

const std::vector<std::string>& Progress::words() {
  static const std::vector<std::string> all = {"auto", "bar", "lines", "none"};
  return all;
}

Progress::Progress(Mode mode, std::string unit, std::uint64_t total, std::uint64_t done)
    : mode_(mode != Mode::automatic        ? mode
            : ::isatty(STDERR_FILENO) != 0 ? Mode::bar
                                           : Mode::lines),
      unit_(std::move(unit)),
      total_(total),
      before_(done),
      done_(done) {}

double Progress::seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
double Progress::rate() const { return static_cast<double>(done_ - before_) / std::max(seconds(), 1e-9); }

void Progress::add(std::uint64_t count) {
  done_ += count;
  if (count == 0 || mode_ == Mode::none) return;
  const double since = std::chrono::duration<double>(Clock::now() - printed_).count();
  if (since < (mode_ == Mode::bar ? 0.2 : 5.0)) return;
  print(false);
}

void Progress::finish() {
  if (mode_ != Mode::bar || !open_) return;
  print(true);
  std::fputc('\n', stderr);
  open_ = false;
}

void Progress::print(bool last) {
  printed_ = Clock::now();
  const double share = total_ == 0 ? 1.0 : static_cast<double>(done_) / static_cast<double>(total_);
  const double left = rate() > 0 ? static_cast<double>(total_ - std::min(done_, total_)) / rate() : 0.0;
  const std::string text =
      fmt::format("{}/{} {} ({:.0f} %), {}{}", done_, total_, unit_, 100.0 * share, rate_text(rate(), unit_),
                  last ? "" : ", " + duration_text(left) + " left");
  if (mode_ == Mode::lines) {
    spdlog::info(text);
    return;
  }
  constexpr int width = 24;
  const int filled = std::min(width, static_cast<int>(share * width));
  fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {}", "", filled, "", width - filled, text);
  std::fflush(stderr);
  open_ = true;
}

std::string rate_text(double per_second, const std::string& unit) {
  if (per_second >= 0.995) return fmt::format("{:.0f} {}/s", per_second, unit);
  if (per_second >= 1.0 / 60) return fmt::format("{:.1f} {}/min", 60 * per_second, unit);
  return fmt::format("{:.1f} {}/h", 3600 * per_second, unit);
}

std::string duration_text(double seconds) {
  const auto s = static_cast<long>(std::ceil(seconds));
  if (s >= 3600) return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
  if (s >= 60) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} s", s);
}

}  // namespace swingbank
