#pragma once
// Progress of commands that process long items: one line per item on standard error, with the number done,
// the rate and the time left.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <string>

#include "base/progress.hpp"

namespace swingbank::jobs {

/// Counter of finished items.
class ItemProgress {
 public:
  /// `unit`: name of the items, for example "plants".
  ItemProgress(std::string unit, std::size_t total) : unit_(std::move(unit)), total_(total) {}
  /// Counts one finished item and prints a line. `was_there`: an earlier run had finished the item, which
  /// therefore does not count in the rate.
  void line(const std::string& text, bool was_there) {
    ++done_;
    if (!was_there) ++made_;
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    const double rate = static_cast<double>(made_) / (spent > 1e-9 ? spent : 1e-9);
    std::string speed;
    if (made_ > 0) speed = ", " + rate_text(rate, unit_);
    if (made_ > 0 && done_ < total_)
      speed += ", " + duration_text(static_cast<double>(total_ - done_) / rate) + " left";
    fmt::print(stderr, "{}/{} {} ({:.0f} %{}): {}\n", done_, total_, unit_,
               100.0 * static_cast<double>(done_) / static_cast<double>(total_), speed, text);
    std::fflush(stderr);
  }

 private:
  std::string unit_;
  std::size_t total_, done_ = 0, made_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace swingbank::jobs
