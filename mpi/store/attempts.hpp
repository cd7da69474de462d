#pragma once
// attempts.jsonl: what became of each run that worked on a dataset. Every run appends its own lines, several
// may do so at once; a run whose last line is no end was killed.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace swingbank::mpi::store {

/// One run on a dataset.
struct Attempt {
  std::string started, ended;               ///< UTC, "2026-11-24T22:14:09Z"; no end: it was killed
  std::string outcome;                      ///< "made", "stopped", "failed: <why>"; empty: it was killed
  std::map<std::string, std::string> told;  ///< host, process, ranks, software, what it found: by name
};

/// Appends the lines of one run.
class AttemptLog {
 public:
  /// Appends the line of a beginning. `told`: of the run and of what it found.
  AttemptLog(const std::filesystem::path& folder, const std::map<std::string, std::string>& told);
  /// Where no end was told, it failed, unless the process is gone: then there is no line.
  ~AttemptLog();
  AttemptLog(const AttemptLog&) = delete;
  AttemptLog& operator=(const AttemptLog&) = delete;
  void tell(const std::string& name, const std::string& value);
  void end(const std::string& outcome);

 private:
  std::filesystem::path file_;
  std::string id_;
  bool ended_ = false;
};

/// In order of beginning. Lines that were torn by a kill are left out.
std::vector<Attempt> read_attempts(const std::filesystem::path& folder);

}  // namespace swingbank::mpi::store
