#include "mpi/store/summary.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "mpi/store/attempts.hpp"

namespace swingbank::mpi::store {

std::string describe_attempts(const std::filesystem::path& folder) {
  const auto attempts = read_attempts(folder);
  std::string text;
  std::size_t killed = 0, failed = 0;
  unsigned long repaired = 0;
  for (const Attempt& a : attempts) {
    killed += a.ended.empty() ? 1 : 0;
    failed += a.outcome == "failed" ? 1 : 0;
    const auto property = [&](const char* name) {
      return a.properties.contains(name) ? a.properties.at(name) : std::string();
    };
    if (!property("shards_repaired").empty()) repaired += std::stoul(property("shards_repaired"));
    text += fmt::format("  {}  {} ranks on {}{}, {} shards found: {}\n", a.started, property("ranks"),
                        property("host"), property("part").empty() ? "" : ", part " + property("part"),
                        property("shards_found"),
                        a.ended.empty() ? "killed, or still running" : a.outcome + " at " + a.ended);
  }
  if (attempts.empty()) return {};
  return fmt::format("{} attempts: {} killed or still running, {} failed; {} shards generated again\n",
                     attempts.size(), killed, failed, repaired) +
         text;
}

std::string describe(const Dataset& d) {
  std::uint64_t bytes = 0, draws = 0;
  for (const auto& s : d.shards) bytes += s.bytes;
  for (const auto& [name, count] : d.outcomes) draws += count;
  std::string text =
      fmt::format("dataset {}: {} rows of {} x {} samples at {:g}/s, {:.1f} MB in {} of {} shards\n",
                  d.path.string(), d.rows, d.channel_names.size(), d.samples, d.rate,
                  static_cast<double>(bytes) / 1e6, d.shards.size(), d.shard_count());
  for (const auto& [name, count] : d.outcomes)
    text += fmt::format(
        "  {:<18}{:>10} draws  {:5.1f} %\n", name, count,
        100.0 * static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(draws, 1)));
  if (const auto& points = d.operating_points; !points.empty()) {
    const auto count = [&](const char* name) { return points.contains(name) ? points.at(name) : 0; };
    text += fmt::format("  {} operating points; rejected: {} without a power flow, {} implausible\n",
                        count("used"), count("no_power_flow"), count("implausible"));
  }
  return text + fmt::format("  config {}  dataset {}\n", d.config_hash, d.complete ? d.hash : "unfinished");
}

}  // namespace swingbank::mpi::store
