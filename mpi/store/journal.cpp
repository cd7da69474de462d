#include "mpi/store/journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <utility>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/sealed_text.hpp"
#include "base/until_done.hpp"
#include "mpi/store/manifest.hpp"

namespace swingbank::mpi::store {

std::string journal_text(const JournalLine& l) {
  nlohmann::ordered_json j;
  j["shard"] = l.shard;
  j["file"] = l.file;
  j["draws"] = l.draws;
  j["rows"] = l.rows;
  j["hash"] = l.hash;
  j["bytes"] = l.bytes;
  j["file_hash"] = l.file_hash;
  j["outcomes"] = l.outcomes;
  if (!l.operating_points.empty()) j["operating_points"] = l.operating_points;
  return sealed_text(j.dump());
}

JournalLine parse_journal_line(const std::string& text) {
  if (!is_sealed(text)) throw std::runtime_error("its checksum is wrong");
  const auto j = nlohmann::json::parse(text);
  JournalLine l;
  j.at("shard").get_to(l.shard);
  j.at("file").get_to(l.file);
  j.at("draws").get_to(l.draws);
  j.at("rows").get_to(l.rows);
  j.at("hash").get_to(l.hash);
  j.at("bytes").get_to(l.bytes);
  j.at("file_hash").get_to(l.file_hash);
  j.at("outcomes").get_to(l.outcomes);
  if (j.contains("operating_points")) j.at("operating_points").get_to(l.operating_points);
  return l;
}

namespace {

/// Returns the length of the text up to its last line feed.
std::size_t whole_lines(const std::string& text) {
  return text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
}

struct Placed {
  JournalLine line;
  std::filesystem::path file;
  int number;             ///< line number from 1
  bool doubtful = false;  ///< whether another entry of the same shard contradicts it
};

/// Returns whether a file has the name of a journal.
bool is_journal(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with("journal") && name.ends_with(".jsonl");
}

constexpr const char* kRepairJournal =
    "run generate with --repair, which generates these shards again, or restore the file from a copy";

std::string place_of(const Placed& p) { return p.file.string() + ":" + std::to_string(p.number); }

std::vector<Placed> read_lines(const std::filesystem::path& file, Problems& damaged) {
  std::vector<Placed> lines;
  const std::string text = read_text(file);
  int number = 0;
  for (std::size_t at = 0, end = whole_lines(text); at < end;) {
    const std::size_t stop = text.find('\n', at);
    ++number;
    try {
      lines.push_back({parse_journal_line(text.substr(at, stop - at)), file, number});
    } catch (const std::exception& e) {
      damaged.add("damaged journal line", file.string() + ":" + std::to_string(number), e.what(),
                  kRepairJournal);
    }
    at = stop + 1;
  }
  return lines;
}

/// Returns one entry per shard; omits contradictory entries.
std::vector<Placed> read_placed(const std::filesystem::path& folder, Problems& damaged) {
  std::vector<Placed> all;
  std::map<std::uint64_t, std::size_t> seen;  // index into `all` by shard
  for (const auto& file : journals_of(folder)) {
    for (Placed& line : read_lines(file, damaged)) {
      const auto [first, is_new] = seen.try_emplace(line.line.shard, all.size());
      if (is_new) {
        all.push_back(std::move(line));
      } else if (Placed& other = all[first->second]; !(other.line == line.line)) {
        damaged.add("shard " + std::to_string(line.line.shard) + " twice", place_of(line),
                    "it differs from " + place_of(other), kRepairJournal);
        other.doubtful = true;
      }
    }
  }
  std::erase_if(all, [](const Placed& p) { return p.doubtful; });
  return all;
}

}  // namespace

std::vector<std::filesystem::path> journals_of(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (is_journal(entry.path())) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

std::string Part::journal_name() const {
  return all() ? "journal.jsonl"
               : "journal-" + std::to_string(number) + "-of-" + std::to_string(of) + ".jsonl";
}

std::vector<JournalLine> read_journals(const std::filesystem::path& folder, Problems* damaged) {
  Problems found;
  std::vector<JournalLine> lines;
  for (Placed& p : read_placed(folder, found)) lines.push_back(std::move(p.line));
  if (damaged == nullptr)
    found.raise();
  else
    damaged->add(found);
  return lines;
}

void strike_lines(const std::filesystem::path& folder, const std::vector<std::uint64_t>& shards) {
  Problems ignored;
  std::map<std::filesystem::path, std::string> texts;
  for (const auto& file : journals_of(folder)) texts[file];
  for (const Placed& p : read_placed(folder, ignored))
    if (std::ranges::find(shards, p.line.shard) == shards.end()) texts[p.file] += journal_text(p.line);
  std::error_code none;
  std::filesystem::remove(folder / kManifestFile, none);
  for (const auto& [file, text] : texts)
    if (text != read_text(file)) write_text(file, text);
}

Journal::Journal(std::filesystem::path file) : file_(std::move(file)) {
  fd_ = until_done([&] { return ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644); });
  if (fd_ < 0) raise_file_error(file_, errno, "cannot open the journal");
  const std::string text = read_text(file_);
  if (const auto whole = whole_lines(text);
      whole != text.size() && ::ftruncate(fd_, static_cast<off_t>(whole)) != 0)
    raise_file_error(file_, errno, "cannot remove the incomplete last line of the journal");
  flush_folder(file_.parent_path());
}

Journal::~Journal() {
  if (fd_ >= 0) ::close(fd_);
}

/// Writes and flushes a text. Returns 0, or errno on failure.
int Journal::add(std::string_view text) const {
  const bool safe = write_all(fd_, text) && until_done([&] { return ::fsync(fd_); }) == 0;
  return safe ? 0 : errno;
}

void Journal::append(std::span<const JournalLine> lines) {
  std::string text;
  for (const JournalLine& line : lines) text += journal_text(line);
  const off_t before = ::lseek(fd_, 0, SEEK_END);
  const int error = add(text);
  if (error == 0) return;
  if (::ftruncate(fd_, before) != 0)
    raise_file_error(file_, error, "cannot write the journal, and its last line may be incomplete");
  raise_file_error(file_, error, "cannot write the journal");
}

}  // namespace swingbank::mpi::store
