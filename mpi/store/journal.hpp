#pragma once
// journal.jsonl: one line per finished shard, appended and flushed after the shard has its final name.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace swingbank::mpi::store {

struct JournalLine {
  std::uint64_t shard = 0;
  std::string file;  ///< relative to the dataset folder
  std::uint64_t draws = 0, rows = 0, bytes = 0;
  std::string hash;  ///< shard hash, 16 hex digits
  std::map<std::string, std::uint64_t> outcomes;
  /// Of blocks that begin in the shard: "used", and "no_power_flow" and "implausible", which were drawn
  /// again.
  std::map<std::string, std::uint64_t> operating_points = {};
};

/// A line as it stands in the file, line feed included, and back. Throws std::exception if the text is no
/// line.
std::string journal_text(const JournalLine& line);
JournalLine parse_journal_line(const std::string& text);

/// Lines in order of the file. A last line without its line feed (the process died in the middle of it) is
/// left out; anything else that is no line, and a shard that stands there twice, throws InputError with the
/// line number. No file: no lines.
std::vector<JournalLine> read_journal(const std::filesystem::path& file);

/// Writes the journal anew with these lines: whole or not at all.
void rewrite_journal(const std::filesystem::path& file, const std::vector<JournalLine>& lines);

/// Appends lines; each is on the disk when `append` returns. Cuts off a half-written last line when it opens.
/// Whoever opens it holds the dataset's lock (run_lock.hpp).
class Journal {
 public:
  explicit Journal(std::filesystem::path file);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;
  void append(const JournalLine& line);

 private:
  std::filesystem::path file_;
  int fd_ = -1;
};

}  // namespace swingbank::mpi::store
