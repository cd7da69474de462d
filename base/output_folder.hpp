#pragma once
// Output folder of a command: locked while the command works and cleared of stale results of earlier runs. It
// never overwrites an input.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/inputs_kept.hpp"
#include "base/run_lock.hpp"

namespace swingbank {

/// Lock on a command's output folder, with a list of the files that the command writes into it.
class OutputFolder {
 public:
  /// Locks the folder; call it after all inputs are read and before the work. `names`: files that the command
  /// may write into the folder; `others`: outputs elsewhere. Throws InputError if an output or a file of an
  /// earlier run is an input, if one of `names` is a result of another command, or if a running command uses
  /// the folder.
  OutputFolder(std::filesystem::path folder, std::string command, const std::vector<std::string>& names,
               const std::vector<Output>& others = {});
  /// Removes the lock file, the files that a run wrote without finishing, and the folder if the constructor
  /// created it and it is empty. Results of an earlier run that were not yet overwritten stay.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Returns the path of the result file `name` and registers it as written by this run.
  std::filesystem::path file(const std::string& name);
  /// Returns the path of the folder.
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  /// Treatment of results of an earlier run that this run has not overwritten.
  enum class Earlier { removed, stay };
  /// Writes the list of results; call it after the last result is written. With Earlier::removed, removes the
  /// results of earlier runs of this command that this run has not overwritten. Keeps a file that was changed
  /// since it was written, because the user has edited it.
  void finish(Earlier earlier = Earlier::removed);

 private:
  /// Returns whether the folder holds this result of an earlier run unchanged.
  [[nodiscard]] bool is_earlier(const std::string& name) const;

  std::filesystem::path folder_;
  std::string command_;
  std::map<std::string, std::string> earlier_;  ///< hashes of an earlier run's files, by name
  std::vector<std::string> written_;
  bool created_ = false, finished_ = false;
  std::optional<RunLock> lock_;
};

}  // namespace swingbank
