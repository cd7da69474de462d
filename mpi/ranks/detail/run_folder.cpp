#include "mpi/ranks/detail/run_folder.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <set>

#include "base/durable.hpp"
#include "mpi/store/index.hpp"
#include "mpi/store/shard_name.hpp"

namespace swingbank::mpi::ranks {

namespace fs = std::filesystem;

namespace {

constexpr const char* kLockFile = ".lock";    ///< lock of a run; runs of different parts share it
constexpr const char* kClaimFile = ".claim";  ///< lock while a part's run checks or completes the folder

FolderLocks lock_folder(const fs::path& folder, const store::Part& part) {
  make_folder(folder);
  const auto lock = [&](const fs::path& file, const std::string& what, RunLock::Kind kind) {
    return std::make_unique<RunLock>(
        file, LockWords{what, folder.string(), "wait until that run ends, or choose another folder"},
        std::chrono::seconds(5), kind);
  };
  if (part.all()) return {lock(folder / kLockFile, "dataset in use", RunLock::Kind::alone), nullptr};
  auto shared = lock(folder / kLockFile, "dataset in use", RunLock::Kind::shared);
  return {std::move(shared),
          lock(folder / fmt::format("{}-{}-of-{}", kLockFile, part.number, part.of),
               fmt::format("part {} of {} in use", part.number, part.of), RunLock::Kind::alone)};
}

/// Lock that gives one of several concurrent parts exclusive access while it checks or completes the folder.
class Claim {
 public:
  Claim(const fs::path& folder, const store::Part& part) {
    if (part.all()) return;
    lock_ = std::make_unique<RunLock>(folder / kClaimFile,
                                      LockWords{"dataset in use", folder.string(), "run the command again"},
                                      std::chrono::minutes(2));
  }
  ~Claim() {
    if (lock_) lock_->withdraw(true);
  }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;

 private:
  std::unique_ptr<RunLock> lock_;
};

/// Returns whether a folder is empty except for files of runs that were killed before they wrote the header.
bool is_unclaimed(const fs::path& folder) {
  const fs::path header = temporary_name(folder / "dataset.json");
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    const bool ours = name.string().starts_with(kLockFile) || name == kClaimFile ||
                      name == header.filename() ||
                      (name == "shards" && entry.is_directory() && fs::is_empty(entry.path()));
    if (!ours) return false;
  }
  return true;
}

}  // namespace

void require_same_config(const fs::path& folder, const store::DatasetHeader& header) {
  const store::DatasetHeader found = store::read_header(folder);
  if (found.config_hash == header.config_hash) return;
  throw InputError(
      {"a dataset of another config", folder.string(),
       fmt::format("its config hash is {} (kernel {}), this run's is {} (kernel {})", found.config_hash,
                   found.kernel, header.config_hash, header.kernel),
       "give another folder, or use the config, size, seed and build that generated this dataset"});
}

bool is_archive(const fs::path& folder) {
  return fs::exists(folder / "dataset.json") && ::access(folder.c_str(), W_OK) != 0;
}

namespace {

/// Writes the header of a new folder, or checks that an existing dataset has the same config. The caller
/// holds the locks. Throws InputError for any other folder.
void claim_folder(const fs::path& folder, const store::DatasetHeader& header, FolderLocks& locks) {
  if (fs::exists(folder / "dataset.json")) return require_same_config(folder, header);
  if (!is_unclaimed(folder)) {
    locks.withdraw();
    throw InputError({"output folder is not empty", folder.string(), "it holds files but no dataset",
                      "give a new or empty folder"});
  }
  store::write_header(folder, header);
}

/// Creates the folder for shards and removes temporary files of killed runs from it.
void clear_leftovers(const fs::path& folder, const store::Part& part, std::uint64_t shards) {
  make_folder(folder / "shards");
  if (part.all()) {
    std::vector<fs::path> leftovers;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "shards")) {
      // Removes only files of this name pattern, because the folder may be a link to a folder with other
      // files.
      const std::string name = entry.path().filename().string();
      if (name.starts_with(".shard-") && name.ends_with(".h5.part")) leftovers.push_back(entry.path());
    }
    for (const auto& file : leftovers) fs::remove(file);
    return;
  }
  for (std::uint64_t shard = part.number - 1; shard < shards; shard += part.of)
    fs::remove(temporary_name(folder / store::shard_file_name(shard, shards)));
}

/// Throws InputError if the folder has parts of another division: part 2 of 3 and part 2 of 4 overlap.
void require_same_cut(const fs::path& folder, const store::Part& part) {
  if (part.all()) return;
  const std::string ending = fmt::format("-of-{}.jsonl", part.of);
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("journal-") && !name.ends_with(ending))
      throw InputError(
          {fmt::format("part {} of {}", part.number, part.of), "--part",
           "the folder has the journal " + name + ", which divides the dataset differently",
           "give --part with the same number of parts as before, or omit it once every part has ended"});
  }
}

}  // namespace

FolderLocks enter(const GenerateOptions& o, const store::DatasetHeader& header,
                  const std::function<void()>& furnish) {
  FolderLocks locks = lock_folder(o.folder, o.part);
  const Claim claim(o.folder, o.part);
  claim_folder(o.folder, header, locks);
  require_same_cut(o.folder, o.part);
  furnish();
  store::Journal begun(o.folder / o.part.journal_name());  // created before another part checks the folder
  clear_leftovers(o.folder, o.part, header.shard_count());
  return locks;
}

std::vector<store::JournalLine> journalled(const GenerateOptions& o) {
  Problems damaged;
  auto lines = store::read_journals(o.folder, o.repair ? &damaged : nullptr);
  for (const auto& p : damaged.list()) spdlog::warn("ignored: {}", p.sentence());
  std::erase_if(lines, [&](const auto& line) { return !o.part.has(line.shard); });
  return lines;
}

void settle(const fs::path& folder, const std::vector<store::BadShard>& bad, bool repair) {
  Problems problems;
  for (const auto& [shard, p] : bad) {
    if (repair) spdlog::warn("the shard is generated again: {} at {} ({})", p.what, p.where, p.why);
    if (!repair) problems.add(p.what, p.where, p.why, p.remedy);
  }
  problems.raise();
  std::vector<std::uint64_t> numbers;
  for (const auto& b : bad) numbers.push_back(b.shard);
  if (repair) store::strike_lines(folder, numbers);
}

void finish(const GenerateOptions& o) {
  const Claim claim(o.folder, o.part);  // two parts may end concurrently
  store::index_dataset(o.folder);
}

std::deque<std::uint64_t> missing_shards(const GenerateOptions& o, const store::DatasetHeader& header) {
  std::set<std::uint64_t> there;
  for (const auto& s : store::open_dataset(o.folder, true).shards) there.insert(s.shard);
  std::deque<std::uint64_t> missing;
  for (std::uint64_t s = 0; s < header.shard_count(); ++s)
    if (o.part.has(s) && !there.contains(s)) missing.push_back(s);
  return missing;
}

}  // namespace swingbank::mpi::ranks
