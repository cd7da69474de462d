#include "mpi/store/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/durable.hpp"
#include "base/problem.hpp"

namespace swingbank::mpi::store {

std::string journal_text(const JournalLine& l) {
  nlohmann::ordered_json j;
  j["shard"] = l.shard;
  j["file"] = l.file;
  j["draws"] = l.draws;
  j["rows"] = l.rows;
  j["hash"] = l.hash;
  j["bytes"] = l.bytes;
  j["outcomes"] = l.outcomes;
  if (!l.operating_points.empty()) j["operating_points"] = l.operating_points;
  return j.dump() + "\n";
}

JournalLine parse_journal_line(const std::string& text) {
  const auto j = nlohmann::json::parse(text);
  JournalLine l;
  j.at("shard").get_to(l.shard);
  j.at("file").get_to(l.file);
  j.at("draws").get_to(l.draws);
  j.at("rows").get_to(l.rows);
  j.at("hash").get_to(l.hash);
  j.at("bytes").get_to(l.bytes);
  j.at("outcomes").get_to(l.outcomes);
  if (j.contains("operating_points")) j.at("operating_points").get_to(l.operating_points);
  if (l.hash.size() != 16) throw std::runtime_error("the hash has not 16 digits");
  return l;
}

namespace {

/// Length of the part that ends with a line feed.
std::size_t whole_lines(const std::string& text) {
  return text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
}

}  // namespace

std::vector<JournalLine> read_journal(const std::filesystem::path& file) {
  std::vector<JournalLine> lines;
  if (!std::filesystem::exists(file)) return lines;
  const std::string text = read_text(file);
  Problems problems;
  std::set<std::uint64_t> seen;
  int number = 0;
  for (std::size_t at = 0, end = whole_lines(text); at < end;) {
    const std::size_t stop = text.find('\n', at);
    const std::string where = file.string() + ":" + std::to_string(++number);
    const char* remedy = "restore the file from a copy, or delete the line: its shard is then made again";
    try {
      lines.push_back(parse_journal_line(text.substr(at, stop - at)));
      if (!seen.insert(lines.back().shard).second)
        problems.add("shard " + std::to_string(lines.back().shard) + " twice", where,
                     "a shard is journalled once", remedy);
    } catch (const std::exception& e) {
      problems.add("damaged journal line", where, e.what(), remedy);
    }
    at = stop + 1;
  }
  problems.raise();
  return lines;
}

void rewrite_journal(const std::filesystem::path& file, const std::vector<JournalLine>& lines) {
  std::string text;
  for (const auto& line : lines) text += journal_text(line);
  write_text(file, text);
}

Journal::Journal(std::filesystem::path file) : file_(std::move(file)) {
  fd_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd_ < 0) raise_file_error(file_, errno, "cannot open the journal");
  const std::string text = read_text(file_);
  if (const auto whole = whole_lines(text);
      whole != text.size() && ::ftruncate(fd_, static_cast<off_t>(whole)) != 0)
    raise_file_error(file_, errno, "cannot cut off the journal's half-written last line");
  flush_folder(file_.parent_path());
}

Journal::~Journal() {
  if (fd_ >= 0) ::close(fd_);
}

void Journal::append(const JournalLine& line) {
  const std::string text = journal_text(line);
  const off_t before = ::lseek(fd_, 0, SEEK_END);
  const ssize_t n = ::write(fd_, text.data(), text.size());
  if (n == static_cast<ssize_t>(text.size()) && ::fsync(fd_) == 0) return;
  const int error = n < 0 || errno != 0 ? errno : ENOSPC;  // a short write means the disk is full
  if (::ftruncate(fd_, before) != 0)
    raise_file_error(file_, error, "cannot write the journal, and its last line is cut short");
  raise_file_error(file_, error, "cannot write the journal");
}

}  // namespace swingbank::mpi::store
