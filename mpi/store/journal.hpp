#pragma once
// Journal of a dataset (journal.jsonl): one line per finished shard. A line is appended and flushed after the
// shard has its final name. Each run that generates a part of a dataset has its own journal.
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::mpi::store {

/// Entry of a finished shard. A draw is one simulated event.
struct JournalLine {
  std::uint64_t shard = 0;                        ///< number in the dataset
  std::string file;                               ///< relative to the dataset folder
  std::uint64_t draws = 0, rows = 0, bytes = 0;   ///< numbers of draws and rows; length of the file [bytes]
  std::string hash;                               ///< shard hash, 16 hex digits
  std::string file_hash;                          ///< hash of the file's bytes (durable.hpp)
  std::map<std::string, std::uint64_t> outcomes;  ///< draws by outcome
  /// Number of operating points of the blocks that begin in the shard: "used", and the rejected ones,
  /// "no_power_flow" and "implausible".
  std::map<std::string, std::uint64_t> operating_points = {};
  /// Compares all members.
  bool operator==(const JournalLine&) const = default;
};

/// Returns the text of an entry, including its checksum and line feed.
std::string journal_text(const JournalLine& line);
/// Parses an entry. Throws std::exception if it is damaged.
JournalLine parse_journal_line(const std::string& text);

/// Subset of the shards that a run generates: all, or every n-th, so that a job array can generate a dataset
/// without MPI.
struct Part {
  std::uint64_t number = 1, of = 1;  ///< counted from 1
  /// Whether the run generates all shards.
  [[nodiscard]] bool all() const { return of == 1; }
  /// Whether the run generates this shard.
  [[nodiscard]] bool has(std::uint64_t shard) const { return shard % of == number - 1; }
  /// Returns "journal.jsonl" or, for a part, "journal-3-of-16.jsonl", so that each file has one writer.
  [[nodiscard]] std::string journal_name() const;
};

/// Returns the journal files of a dataset folder, in order of name.
std::vector<std::filesystem::path> journals_of(const std::filesystem::path& folder);

/// Returns the entries of all journals of a dataset folder. Ignores a last line without line feed, which a
/// killed process leaves, and returns identical entries once. Omits other damaged lines and contradictory
/// entries of a shard, and adds these problems to `damaged`. Throws InputError instead if `damaged` is null.
std::vector<JournalLine> read_journals(const std::filesystem::path& folder, Problems* damaged = nullptr);

/// Removes the manifest, then rewrites the journals atomically without these shards, damaged lines and
/// contradictory entries.
void strike_lines(const std::filesystem::path& folder, const std::vector<std::uint64_t>& shards);

/// Open journal. The constructor removes an incomplete last line. The caller must hold the dataset's lock
/// (run_lock.hpp).
class Journal {
 public:
  /// Opens or creates the journal. Throws InputError on failure.
  explicit Journal(std::filesystem::path file);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;
  /// Appends entries durably, with one flush. On failure, removes them and throws InputError.
  void append(std::span<const JournalLine> lines);

 private:
  [[nodiscard]] int add(std::string_view text) const;
  std::filesystem::path file_;
  int fd_ = -1;
};

}  // namespace swingbank::mpi::store
