#pragma once
// Error messages and exit code of a command that throws.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "base/stop_signal.hpp"

namespace swingbank::jobs {

/// Returns the problems of an input, one per line. Problems that differ only in their place share a line.
inline std::string problems_text(const InputError& error) {
  std::vector<Problem> lines;
  for (const Problem& p : error.problems()) {
    const auto same = std::ranges::find_if(
        lines, [&](const Problem& q) { return q.what == p.what && q.why == p.why && q.remedy == p.remedy; });
    if (same == lines.end())
      lines.push_back(p);
    else
      same->where += ", " + p.where;
  }
  std::string text;
  for (const Problem& p : lines) text += p.sentence() + "\n";
  return text;
}

/// Returns the message of a failed write to standard output; errno must hold its reason.
inline std::string unwritable_output() {
  return Problem{"cannot write the result", "standard output", std::strerror(errno),
                 "free space, or redirect it elsewhere"}
      .sentence();
}

/// Runs `action` and returns its exit code. Prints an exception as an error message and returns 1, also if
/// standard output cannot be written. Returns 2 if a stop signal ended the action before any result.
template <class F>
int guarded(const std::string& command, F action) {
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the limit of a file's size then fails with a message
  try {
    const int code = action();
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
    fmt::print(stderr, "{}\n", unwritable_output());
  } catch (const Interrupted&) {
    fmt::print(stderr, "swingbank {}: stopped by a signal before the first result; nothing was written\n",
               command);
    return kSubmitAgain;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}", problems_text(error));
  } catch (const std::bad_alloc&) {
    fmt::print(
        stderr,
        "out of memory at swingbank {} (this machine or the limit of its process is too small for the input): use "
        "shorter or fewer records, or lower rates\n",
        command);
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0)
      fmt::print(stderr, "{}\n", unwritable_output());
    else
      fmt::print(stderr, "swingbank {}: {}\n", command, error.what());
  }
  return 1;
}

}  // namespace swingbank::jobs
