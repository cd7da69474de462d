#pragma once
// Log of the runs on a dataset (attempts.jsonl) with their outcomes. Each run appends its own lines, and
// several runs may append concurrently. A run without an end line was killed or is still active.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace swingbank::mpi::store {

/// One run on a dataset.
struct Attempt {
  std::string started, ended;  ///< UTC, "2026-11-24T22:14:09Z"; `ended` is empty without an end line
  std::string outcome;         ///< "made", "stopped" or "failed"; empty without an end line
  std::map<std::string, std::string> properties;  ///< by name: host, process, ranks, software, shards found
};

/// Writer of one run's lines.
class AttemptLog {
 public:
  /// Appends the line for the start of the run. `properties`: host, ranks and software of the run, and the
  /// shards that it found.
  AttemptLog(const std::filesystem::path& folder, const std::map<std::string, std::string>& properties);
  /// Appends the outcome "failed" unless end() was called.
  ~AttemptLog();
  AttemptLog(const AttemptLog&) = delete;
  AttemptLog& operator=(const AttemptLog&) = delete;
  /// Appends another property of the run.
  void add_property(const std::string& name, const std::string& value);
  /// Appends the line for the end of the run. `outcome`: "made", "stopped" or "failed".
  void end(const std::string& outcome);

 private:
  std::filesystem::path file_;
  std::string id_;
  bool ended_ = false;
};

/// Returns the runs in order of their start. Skips incomplete lines of killed runs.
std::vector<Attempt> read_attempts(const std::filesystem::path& folder);

}  // namespace swingbank::mpi::store
