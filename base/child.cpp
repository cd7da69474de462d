#include "base/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <optional>

#include "base/problem.hpp"
#include "base/until_done.hpp"

extern char** environ;

namespace swingbank {
namespace {

using Clock = std::chrono::steady_clock;

std::optional<Clock::time_point> end_after(double limit) {
  if (limit <= 0.0) return {};
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit));
}

/// Returns the time until `end` for poll(2) [ms]; -1: no time limit.
int until(std::optional<Clock::time_point> end) {
  using namespace std::chrono;
  return end ? static_cast<int>(std::max<long>(0, ceil<milliseconds>(*end - Clock::now()).count())) : -1;
}

/// Reads the pipe into `ended.output` until its other end is closed. Kills the child after `limit` [s].
void take_output(int pipe, pid_t child, double limit, ProgramEnd& ended) {
  auto end = end_after(limit);
  std::array<char, 4096> piece{};
  for (;;) {
    pollfd wait{pipe, POLLIN, 0};
    const int ready = ::poll(&wait, 1, until(end));
    if (ready < 0) continue;  // interrupted by a signal
    if (ready == 0) {
      ended.late = true;
      ::kill(child, SIGKILL);  // also ends a stopped process
      end.reset();
      continue;
    }
    const ssize_t n = until_done([&] { return ::read(pipe, piece.data(), piece.size()); });
    if (n <= 0) return;
    ended.output.append(piece.data(), static_cast<std::size_t>(n));
  }
}

[[noreturn]] void cannot_start(const std::filesystem::path& program, int error) {
  throw InputError(
      {"cannot start the program", program.string(), std::strerror(error), "check that it can be run"});
}

}  // namespace

pid_t start_child(const std::function<int()>& work, int at_our_end) {
  std::fflush(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child != 0) return child;
  ::prctl(PR_SET_PDEATHSIG, at_our_end);
  if (::getppid() != parent) ::_exit(1);
  ::_exit(work());
}

int wait_for_child(pid_t child) {
  int status = 0;
  until_done([&] { return ::waitpid(child, &status, 0); });
  return status;
}

int ProgramEnd::code() const { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

ProgramEnd run_program(const std::filesystem::path& program, const std::vector<std::string>& words,
                       const ProgramRun& how) {
  std::vector<char*> arguments;
  for (const auto& w : words) arguments.push_back(const_cast<char*>(w.c_str()));
  arguments.push_back(nullptr);
  const bool taken = how.output == ProgramRun::Output::taken;
  std::array<int, 2> ends{-1, -1};
  if (taken && ::pipe2(ends.data(), O_CLOEXEC) != 0) cannot_start(program, errno);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (taken) posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  if (how.output == ProgramRun::Output::dropped)
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  if (how.silent) posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failure = ::posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (taken) ::close(ends[1]);
  ProgramEnd ended;
  if (failure == 0 && taken) take_output(ends[0], child, how.limit, ended);
  if (taken) ::close(ends[0]);
  if (failure != 0) cannot_start(program, failure);
  ended.status = wait_for_child(child);
  return ended;
}

}  // namespace swingbank
