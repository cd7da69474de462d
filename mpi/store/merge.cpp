#include "mpi/store/merge.hpp"

#include <fmt/format.h>

#include <chrono>
#include <map>

#include "base/durable.hpp"
#include "base/problem.hpp"
#include "base/run_lock.hpp"
#include "base/stop_signal.hpp"
#include "mpi/store/index.hpp"
#include "mpi/store/shard_name.hpp"

namespace swingbank::mpi::store {

namespace fs = std::filesystem;

namespace {

/// Returns the header common to all folders. Throws InputError for each folder with another config.
DatasetHeader common_header(const std::vector<fs::path>& folders) {
  const DatasetHeader first = read_header(folders.front());
  Problems problems;
  for (const fs::path& folder : folders) {
    const DatasetHeader h = read_header(folder);
    if (h.config_hash != first.config_hash)
      problems.add("a dataset of another config", folder.string(),
                   "its header (config hash " + h.config_hash + ", kernel " + h.kernel + ") is not that of " +
                       folders.front().string() + " (" + first.config_hash + ", kernel " + first.kernel + ")",
                   "merge only datasets that one build generated from the same config, size and seed");
  }
  problems.raise();
  return first;
}

/// Copies a shard atomically and verifies the copy.
void copy_shard(const fs::path& from, const JournalLine& line, const fs::path& to) {
  const fs::path temporary = temporary_name(to);
  std::error_code error;
  make_folder(to.parent_path());
  fs::remove(temporary, error);
  fs::copy_file(from, temporary, error);
  if (error) {
    const int number = error.value();
    fs::remove(temporary, error);
    raise_file_error(to, number, "cannot copy the shard " + from.string());
  }
  if (const std::string found = hash_of_file(temporary); found != line.file_hash) {
    fs::remove(temporary, error);
    throw InputError({"changed shard", from.string(),
                      "the hash of its bytes is " + found + ", its journal records " + line.file_hash,
                      kRepairDataset});
  }
  publish(to);
}

class Merge {
 public:
  Merge(fs::path into, const DatasetHeader& header) : into_(std::move(into)), shards_(header.shard_count()) {
    for (JournalLine& l : read_journals(into_)) there_.emplace(l.shard, std::move(l));
  }
  void add(const fs::path& folder, const std::function<void()>& done) {
    Journal journal(into_ / "journal.jsonl");
    for (const JournalLine& line : read_journals(folder)) {
      if (stop_asked()) return;
      try {
        add_line(folder, line, journal);
      } catch (const InputError& e) {
        problems_.add(e);
      }
      done();
    }
  }
  void raise() const { problems_.raise(); }

 private:
  void add_line(const fs::path& folder, const JournalLine& line, Journal& journal) {
    if (const auto found = there_.find(line.shard); found != there_.end()) {
      if (found->second.hash != line.hash || found->second.file_hash != line.file_hash)
        throw InputError(
            {"shard " + std::to_string(line.shard) + " twice", folder.string(),
             fmt::format("its rows and its file have the hashes {} and {}, those in {} have {} and {}",
                         line.hash, line.file_hash, into_.string(), found->second.hash,
                         found->second.file_hash),
             "verify both folders with swingbank verify, and merge the valid one"});
      return;
    }
    JournalLine mine = line;
    mine.file = shard_file_name(line.shard, shards_);
    copy_shard(folder / line.file, line, into_ / mine.file);
    journal.append({&mine, 1});
    there_.emplace(mine.shard, std::move(mine));
  }

  fs::path into_;
  std::uint64_t shards_;
  std::map<std::uint64_t, JournalLine> there_;
  Problems problems_;
};

}  // namespace

void merge_datasets(const std::vector<fs::path>& from, const fs::path& into,
                    const std::function<void()>& done) {
  const DatasetHeader header = common_header(from);
  make_folder(into);
  const RunLock lock(
      into / ".lock",
      LockWords{"dataset in use", into.string(), "wait until that run ends, or choose another folder"},
      std::chrono::seconds(5));
  if (fs::exists(into / "dataset.json")) {
    common_header({from.front(), into});
  } else {
    for (const auto& entry : fs::directory_iterator(into))
      if (!entry.path().filename().string().starts_with('.'))
        throw InputError({"output folder is not empty", into.string(), "it holds files but no dataset",
                          "give a new or empty folder"});
    write_header(into, header);
  }
  for (const fs::path& folder : from)
    if (fs::exists(folder / "card.json") && !fs::exists(into / "card.json"))
      write_text(into / "card.json", read_text(folder / "card.json"));
  Merge merge(into, header);
  for (const fs::path& folder : from) merge.add(folder, done);
  merge.raise();
  index_dataset(into);
}

}  // namespace swingbank::mpi::store
