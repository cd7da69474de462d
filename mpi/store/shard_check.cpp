#include "mpi/store/shard_check.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "base/child.hpp"
#include "base/json.hpp"
#include "base/until_done.hpp"

namespace swingbank::mpi::store {

namespace {

struct Reader {
  pid_t process = -1;
  int pipe = -1;
  std::string text;  ///< incomplete last line
};

/// Returns the output line of a shard: its problem, or an empty line if it is valid.
std::string line_of(const JournalLine& shard, const std::optional<Problem>& p) {
  return p ? bad_shard_text({shard.shard, *p}) : "\n";
}

int read_share(const std::filesystem::path& folder, const DatasetHeader& header,
               const std::vector<JournalLine>& lines, std::size_t first, std::size_t step, int out) {
  try {
    for (std::size_t i = first; i < lines.size(); i += step)
      if (!write_all(out, line_of(lines[i], fault_of(folder, lines[i], header, true)))) ::_exit(1);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
  return 0;
}

void take_lines(Reader& r, std::vector<BadShard>& bad, const std::function<void()>& done) {
  std::size_t at = 0;
  for (std::size_t end; (end = r.text.find('\n', at)) != std::string::npos; at = end + 1) {
    if (end > at) bad.push_back(parse_bad_shard(r.text.substr(at, end - at)));
    done();
  }
  r.text.erase(0, at);
}

void end_reader(Reader& r) {
  ::close(r.pipe);
  r.pipe = -1;
  const int status = wait_for_child(r.process);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  throw InputError({"a process that read shards ended early", "process " + std::to_string(r.process),
                    WIFSIGNALED(status) ? ::strsignal(WTERMSIG(status)) : "its reason is reported above",
                    "run the command again, with fewer --processes if memory is insufficient"});
}

Reader start_reader(const std::function<int(int)>& work) {
  std::array<int, 2> ends{};
  const bool piped = ::pipe(ends.data()) == 0;
  const auto read = [&] {
    ::close(ends[0]);
    return work(ends[1]);
  };
  const pid_t child = piped ? start_child(read, SIGKILL) : -1;
  if (child < 0)
    throw InputError(
        {"a process cannot be started", "--processes", std::strerror(errno), "give a smaller number"});
  ::close(ends[1]);
  return {child, ends[0], {}};
}

/// Reads the lines of all child processes until they have ended.
void listen(std::vector<Reader>& readers, std::vector<BadShard>& bad, const std::function<void()>& done) {
  for (std::size_t open = readers.size(); open > 0;) {
    std::vector<pollfd> waits;
    for (const Reader& r : readers) waits.push_back({r.pipe, POLLIN, 0});
    if (::poll(waits.data(), waits.size(), -1) < 0) continue;
    for (std::size_t i = 0; i < readers.size(); ++i) {
      if (waits[i].revents == 0) continue;
      std::array<char, 4096> piece{};
      const ssize_t n = until_done([&] { return ::read(readers[i].pipe, piece.data(), piece.size()); });
      if (n > 0) readers[i].text.append(piece.data(), static_cast<std::size_t>(n));
      take_lines(readers[i], bad, done);
      if (n > 0) continue;
      end_reader(readers[i]);
      --open;
    }
  }
}

}  // namespace

std::string bad_shard_text(const BadShard& bad) {
  const auto& [what, where, why, remedy] = bad.problem;
  return json_text({bad.shard, what, where, why, remedy}) + "\n";
}

BadShard parse_bad_shard(const std::string& text) {
  const auto j = nlohmann::json::parse(text);
  return {j[0], {j[1], j[2], j[3], j[4]}};
}

std::vector<BadShard> bad_shards(const std::filesystem::path& folder, const DatasetHeader& header,
                                 const std::vector<JournalLine>& lines, int processes,
                                 const std::function<void()>& done) {
  std::vector<BadShard> bad;
  if (processes <= 1) {
    for (const JournalLine& line : lines) {
      if (const auto p = fault_of(folder, line, header, true)) bad.push_back({line.shard, *p});
      done();
    }
  } else {
    std::vector<Reader> readers;
    const auto step = static_cast<std::size_t>(processes);
    for (std::size_t k = 0; k < std::min(step, lines.size()); ++k)
      readers.push_back(
          start_reader([&](int out) { return read_share(folder, header, lines, k, step, out); }));
    listen(readers, bad, done);
  }
  std::ranges::sort(bad, {}, &BadShard::shard);
  return bad;
}

void verify_dataset(const Dataset& dataset) {
  Problems problems;
  for (const auto& [shard, p] : bad_shards(dataset.path, dataset, read_journals(dataset.path), 1))
    problems.add(p.what, p.where, p.why, p.remedy);
  problems.raise();
}

}  // namespace swingbank::mpi::store
