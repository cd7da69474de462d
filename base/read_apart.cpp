#include "base/read_apart.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include "base/child.hpp"
#include "base/json.hpp"
#include "base/own_command.hpp"
#include "base/problem.hpp"
#include "base/until_done.hpp"

namespace swingbank {
namespace {

constexpr double kPatience = 300.0;          ///< wall-clock limit [s]: slow disk or stopped process
constexpr rlim_t kProcessorTime = 30;        ///< processor time limit [s]: endless loop on a damaged file
constexpr std::uintmax_t kSlow = 5'000'000;  ///< both limits grow by file size / this rate [bytes/s]
constexpr int kProblemsReported = 3;         ///< exit code: the output is a list of problems
constexpr const char* kWhat = "cannot read the file";
constexpr const char* kRemedy = "copy the file again from its source, or generate it again";

/// Returns the problems in the reader's output; empty if it is not a list of problems.
std::vector<Problem> problems_in(const std::string& text) {
  const auto list = nlohmann::json::parse(text, nullptr, false);
  std::vector<Problem> problems;
  if (!list.is_array()) return problems;
  for (const auto& p : list) {
    if (!p.is_array() || p.size() != 4) return {};
    for (const auto& part : p)
      if (!part.is_string()) return {};
    problems.push_back({p[0], p[1], p[2], p[3]});
  }
  return problems;
}

std::string way_to_end(const ProgramEnd& ended, double patience) {
  if (ended.late) return "reading did not end within " + std::to_string(static_cast<int>(patience)) + " s";
  if (WIFSIGNALED(ended.status))
    return std::string("a signal ended the reading process: ") + ::strsignal(WTERMSIG(ended.status));
  return "the reading process ended with code " + std::to_string(ended.code());
}

}  // namespace

std::string read_apart(const std::string& kind, const std::filesystem::path& file,
                       const std::vector<std::string>& words) {
  const auto program = jobs::own_command("read-hdf5", "build or install all parts of Swingbank");
  std::vector<std::string> all{program.string(), kind, file.string()};
  all.insert(all.end(), words.begin(), words.end());
  std::error_code none;
  const double size = static_cast<double>(std::filesystem::file_size(file, none));
  const double patience = kPatience + (none ? 0.0 : size / static_cast<double>(kSlow));
  ProgramEnd ended = run_program(program, all, {ProgramRun::Output::taken, true, patience});
  if (!ended.late && WIFEXITED(ended.status)) {
    if (WEXITSTATUS(ended.status) == 0) return std::move(ended.output);
    if (WEXITSTATUS(ended.status) == kProblemsReported)
      if (auto problems = problems_in(ended.output); !problems.empty()) throw InputError(std::move(problems));
  }
  throw InputError(
      {kWhat, file.string(), way_to_end(ended, patience) + "; the file may be damaged", kRemedy});
}

int reply_apart(const std::filesystem::path& file, const std::function<std::string()>& work) {
  const char* asked = std::getenv("SWINGBANK_READER_SECONDS");
  std::error_code none;
  const auto size = std::filesystem::file_size(file, none);
  const rlim_t seconds =
      (asked != nullptr && std::atol(asked) > 0 ? static_cast<rlim_t>(std::atol(asked)) : kProcessorTime) +
      (none ? 0 : static_cast<rlim_t>(size / kSlow));
  const rlimit limit{seconds, seconds}, no_core{0, 0};
  ::setrlimit(RLIMIT_CPU, &limit);
  ::setrlimit(RLIMIT_CORE, &no_core);  // no core file, because a crash is an expected result
  nlohmann::json problems = nlohmann::json::array();
  try {
    return write_all(STDOUT_FILENO, work()) ? 0 : 1;
  } catch (const InputError& e) {
    for (const Problem& p : e.problems()) problems.push_back({p.what, p.where, p.why, p.remedy});
  } catch (const std::bad_alloc&) {
    problems.push_back({kWhat, file.string(), "too little memory", "use a machine with more memory"});
  }
  return write_all(STDOUT_FILENO, json_text(problems)) ? kProblemsReported : 1;
}

}  // namespace swingbank
