#pragma once
// The folder of a command's results: locked while the command works, without stale results of an earlier run
// of the same command afterwards, and never at the cost of an input.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/inputs_kept.hpp"
#include "base/run_lock.hpp"

namespace swingbank {

class OutputFolder {
 public:
  /// Once all inputs are read, before the work. `names`: files that the command may write in it; `others`:
  /// outputs elsewhere. Throws InputError where an output is an input, where a file of an earlier run, which
  /// may be removed, is one, and where another command works in the folder.
  OutputFolder(std::filesystem::path folder, std::string command, const std::vector<std::string>& names,
               const std::vector<Output>& others = {});
  /// Leaves no lock file, and no empty folder that was not there before.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Path of a result of this run.
  std::filesystem::path file(const std::string& name);
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  /// What becomes of the results of an earlier run that this run has not written anew.
  enum class Earlier { removed, stay };
  /// Once the results are written. Removes those of an earlier run of this command; a file that was changed
  /// since stays, because it is the user's now.
  void finish(Earlier earlier = Earlier::removed);

 private:
  std::filesystem::path folder_;
  std::string command_;
  std::map<std::string, std::string> earlier_;  ///< names and hashes of the files of an earlier run
  std::vector<std::string> written_;
  bool created_ = false;
  std::optional<RunLock> lock_;
};

}  // namespace swingbank
