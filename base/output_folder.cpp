#include "base/output_folder.hpp"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/durable.hpp"
#include "base/problem.hpp"

namespace swingbank {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kListPrefix = ".swingbank-";
constexpr const char* kLockFile = ".swingbank-lock";

fs::path list_file(const fs::path& folder, const std::string& command) {
  return folder / (std::string(kListPrefix) + command);
}

/// Reads lines of "hash name". Ignores names that contain a folder, because this program never writes them.
std::map<std::string, std::string> read_list(const fs::path& file) {
  std::map<std::string, std::string> all;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return all;
  std::istringstream lines(read_text(file));
  for (std::string hash, name; lines >> hash && std::getline(lines >> std::ws, name);)
    if (fs::path(name).filename() == name && !fs::path(name).empty()) all[name] = hash;
  return all;
}

/// Throws InputError if the folder has results of another command under one of `names`.
void require_no_results_of_others(const fs::path& folder, const std::string& command,
                                  const std::vector<std::string>& names) {
  std::error_code none;
  std::map<std::string, std::string> owners;  // command of each file, by name
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string list = entry.path().filename().string();
    if (!list.starts_with(kListPrefix) || list == kLockFile || entry.path() == list_file(folder, command))
      continue;
    for (const auto& [name, hash] : read_list(entry.path()))
      if (std::ranges::find(names, name) != names.end() && fs::exists(folder / name, none))
        owners[name] = list.substr(kListPrefix.size());
  }
  Problems problems;
  for (const auto& [name, owner] : owners)
    problems.add(name + " of 'swingbank " + owner + "'", "--out " + folder.string(),
                 "'" + command + "' would replace it", "give another folder");
  problems.raise();
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder, std::string command, const std::vector<std::string>& names,
                           const std::vector<Output>& others)
    : folder_(std::move(folder)), command_(std::move(command)) {
  earlier_ = read_list(list_file(folder_, command_));
  std::vector<Output> outputs;
  for (const std::string& name : names) outputs.push_back({folder_ / name, "--out"});
  for (const auto& [name, hash] : earlier_)
    if (std::ranges::find(names, name) == names.end()) outputs.push_back({folder_ / name, "--out"});
  outputs.insert(outputs.end(), others.begin(), others.end());
  require_inputs_kept(outputs);
  require_no_results_of_others(folder_, command_, names);
  std::error_code none;
  created_ = !fs::exists(folder_, none);
  make_folder(folder_);
  lock_.emplace(folder_ / kLockFile,
                LockWords{"output folder in use", "--out " + folder_.string(),
                          "wait until that run ends, or give another folder"},
                std::chrono::milliseconds(0));
  // Read again, because the previous holder of the lock may have changed the list.
  earlier_ = read_list(list_file(folder_, command_));
}

OutputFolder::~OutputFolder() {
  std::error_code none;
  if (!finished_)
    for (const std::string& name : written_)
      if (!is_earlier(name)) fs::remove(folder_ / name, none);
  if (lock_) lock_->withdraw(true);
  if (created_ && fs::is_empty(folder_, none)) fs::remove(folder_, none);
}

fs::path OutputFolder::file(const std::string& name) {
  if (std::ranges::find(written_, name) == written_.end()) written_.push_back(name);
  return folder_ / name;
}

bool OutputFolder::is_earlier(const std::string& name) const {
  const auto found = earlier_.find(name);
  std::error_code none;
  const fs::path file = folder_ / name;
  return found != earlier_.end() && fs::is_regular_file(file, none) && hash_of_file(file) == found->second;
}

void OutputFolder::finish(Earlier earlier) {
  std::error_code none;
  std::string list;
  for (const auto& [name, hash] : earlier_) {
    const fs::path file = folder_ / name;
    if (std::ranges::find(written_, name) != written_.end() || !is_earlier(name)) continue;
    if (earlier == Earlier::stay) {
      list += hash + " " + name + "\n";
      continue;
    }
    require_inputs_kept({{file, "--out"}});
    fs::remove(file, none);
  }
  for (const std::string& name : written_)
    if (fs::is_regular_file(folder_ / name, none)) list += hash_of_file(folder_ / name) + " " + name + "\n";
  write_text(list_file(folder_, command_), list);
  finished_ = true;
}

}  // namespace swingbank
