#include "mpi/store/attempts.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/sealed_text.hpp"
#include "base/until_done.hpp"

namespace swingbank::mpi::store {

namespace fs = std::filesystem;

namespace {

constexpr const char* kAttemptsFile = "attempts.jsonl";

std::string utc_now() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

/// Appends a line with a single write(2), so that lines of several runs do not mix. It begins with a line
/// feed, which separates it from an incomplete line of a killed run.
void append_attempt(const fs::path& file, const nlohmann::ordered_json& line) {
  const std::string text = "\n" + sealed_text(json_text(line));
  const int fd =
      until_done([&] { return ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644); });
  if (fd < 0) raise_file_error(file, errno, "cannot open the list of attempts");
  const ssize_t written = until_done([&] { return ::write(fd, text.data(), text.size()); });
  int error = written < 0 ? errno : 0;
  if (error == 0 && written < static_cast<ssize_t>(text.size())) error = ENOSPC;
  if (error == 0 && until_done([&] { return ::fsync(fd); }) != 0) error = errno;
  ::close(fd);
  if (error != 0) raise_file_error(file, error, "cannot write the list of attempts");
}

std::string name_of_this_run() {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  return fmt::format("{} {} {}", host, ::getpid(), utc_now());
}

}  // namespace

AttemptLog::AttemptLog(const fs::path& folder, const std::map<std::string, std::string>& properties)
    : file_(folder / kAttemptsFile), id_(name_of_this_run()) {
  nlohmann::ordered_json line = {{"run", id_}, {"event", "begins"}, {"time", utc_now()}};
  for (const auto& [name, value] : properties) line[name] = value;
  append_attempt(file_, line);
}

void AttemptLog::add_property(const std::string& name, const std::string& value) {
  append_attempt(file_, {{"run", id_}, {"event", "property"}, {"time", utc_now()}, {name, value}});
}

void AttemptLog::end(const std::string& outcome) {
  ended_ = true;
  append_attempt(file_, {{"run", id_}, {"event", "ends"}, {"time", utc_now()}, {"outcome", outcome}});
}

AttemptLog::~AttemptLog() {
  if (ended_) return;
  try {
    end("failed");
  } catch (const std::exception&) {  // ignored: the disk may be full
  }
}

std::vector<Attempt> read_attempts(const fs::path& folder) {
  std::vector<Attempt> attempts;
  if (!fs::exists(folder / kAttemptsFile)) return attempts;
  std::map<std::string, std::size_t> place;
  const std::string text = read_text(folder / kAttemptsFile);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    if (line.empty() || !is_sealed(line)) continue;
    const auto j = nlohmann::json::parse(line);
    const auto [found, is_new] = place.try_emplace(j.at("run"), attempts.size());
    if (is_new) attempts.push_back({j.at("time"), "", "", {}});
    Attempt& a = attempts[found->second];
    if (j.at("event") == "ends") {
      a.ended = j.at("time");
      a.outcome = j.at("outcome");
    }
    for (const auto& [name, value] : j.items())
      if (name != "run" && name != "event" && name != "time" && name != "sum" && name != "outcome")
        a.properties[name] = value.get<std::string>();
  }
  return attempts;
}

}  // namespace swingbank::mpi::store
