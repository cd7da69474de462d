#pragma once
// journal.jsonl: one line per finished shard, appended and flushed after the shard has its final name. Runs
// that make a part of a dataset each have a journal of their own.
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::mpi::store {

struct JournalLine {
  std::uint64_t shard = 0;
  std::string file;  ///< relative to the dataset folder
  std::uint64_t draws = 0, rows = 0, bytes = 0;
  std::string hash;       ///< shard hash, 16 hex digits
  std::string file_hash;  ///< of the file's bytes (durable.hpp)
  std::map<std::string, std::uint64_t> outcomes;
  /// Of blocks that begin in the shard: "used", and "no_power_flow" and "implausible", which were drawn
  /// again.
  std::map<std::string, std::uint64_t> operating_points = {};
  bool operator==(const JournalLine&) const = default;
};

/// A line as it stands in the file, line feed included, and back. Throws std::exception if the text is no
/// line.
std::string journal_text(const JournalLine& line);
JournalLine parse_journal_line(const std::string& text);

/// Which shards a run makes: all, or every n-th, so that a job array makes a dataset without a launcher.
struct Part {
  std::uint64_t number = 1, of = 1;  ///< counted from 1
  [[nodiscard]] bool all() const { return of == 1; }
  [[nodiscard]] bool has(std::uint64_t shard) const { return shard % of == number - 1; }
  /// "journal.jsonl", of a part "journal-3-of-16.jsonl": one file, one writer.
  [[nodiscard]] std::string journal_name() const;
};

/// The journals of a dataset folder, in order of name.
std::vector<std::filesystem::path> journals_of(const std::filesystem::path& folder);

/// All journals of a dataset folder. A last line without its line feed (the process died in the middle of it)
/// is left out, and a line that stands there twice counts once. Anything else that is no line, and a shard of
/// which two lines say different things, throws InputError with files and line numbers; where `damaged` is
/// given, such lines are left out and told there. No journal: no lines.
std::vector<JournalLine> read_journals(const std::filesystem::path& folder, Problems* damaged = nullptr);

/// Writes the journals anew without these shards and without damaged lines: each whole or not at all. The
/// manifest goes first.
void strike_lines(const std::filesystem::path& folder, const std::vector<std::uint64_t>& shards);

/// Appends lines; all are on the disk when `append` returns, with one flush. Cuts off a half-written last
/// line when it opens. Whoever opens it holds the dataset's lock (run_lock.hpp).
class Journal {
 public:
  explicit Journal(std::filesystem::path file);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;
  void append(std::span<const JournalLine> lines);

 private:
  [[nodiscard]] int add(std::string_view text) const;
  std::filesystem::path file_;
  int fd_ = -1;
};

}  // namespace swingbank::mpi::store
