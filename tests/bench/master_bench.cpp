// Utilisation of the workers by a master. The workers are simulated with a separate clock; each reply is
// that of the real master with its measured time, plus the cost to pack, send and unpack a report. For
// comparison: a master that leases one shard at a time and flushes the disk in each reply.
//   bench_master [seconds of a shard, default 0.33] [milliseconds of a flush, default 20]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <queue>
#include <random>
#include <thread>

#include "mpi/ranks/detail/master.hpp"
#include "mpi/ranks/session.hpp"

namespace {
using namespace swingbank;
using namespace swingbank::mpi;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

store::JournalLine line_of(std::uint64_t shard) {
  return {shard,
          fmt::format("shards/shard-{:06}.h5", shard),
          1000,
          990,
          43'000'000,
          "0123456789abcdef",
          "0123456789abcdef",
          {{"stable", 980}, {"unstable", 10}, {"refused", 10}}};
}

/// Time of a report with the given number of shards, from pack to unpack [s].
double message_cost(std::size_t shards) {
  ranks::Report report;
  for (std::size_t i = 0; i < shards; ++i) report.finished.push_back(line_of(i));
  constexpr int kRounds = 2000;
  const auto start = Clock::now();
  for (int i = 0; i < kRounds; ++i) {
    const std::string text = ranks::pack(report);
    std::string got(text.size(), '\0');
    MPI_Sendrecv(text.data(), static_cast<int>(text.size()), MPI_CHAR, 0, ranks::kReportTag, got.data(),
                 static_cast<int>(got.size()), MPI_CHAR, 0, ranks::kReportTag, MPI_COMM_SELF,
                 MPI_STATUS_IGNORE);
    (void)ranks::unpack(got);
  }
  return since(start) / kRounds;
}

/// One reply: the shards of the next lease, and the master's time for it [s].
using Reply = std::function<std::pair<ranks::Shards, double>(ranks::Report&, int rank)>;

struct Outcome {
  double busy = 0.0;       ///< busy fraction of the workers' time
  double per_reply = 0.0;  ///< master's time [s]
};

Outcome simulate(int workers, double shard_seconds, const Reply& reply) {
  struct Asking {
    double at;  ///< arrival time of its report at the master [s]
    int rank;
    bool operator>(const Asking& other) const { return at > other.at; }
  };
  std::mt19937_64 random(1);
  std::gamma_distribution<double> cost(16.0,
                                       shard_seconds / 16.0);  // relative standard deviation 0.25
  std::priority_queue<Asking, std::vector<Asking>, std::greater<>> queue;
  std::vector<ranks::Report> reports(static_cast<std::size_t>(workers) + 1);
  for (int r = 1; r <= workers; ++r) queue.push({0.0, r});
  double free_at = 0.0, worked = 0.0, served = 0.0, last = 0.0;
  std::uint64_t replies = 0;
  while (!queue.empty()) {
    const auto [at, rank] = queue.top();
    queue.pop();
    ranks::Report& report = reports[static_cast<std::size_t>(rank)];
    const auto [lease, seconds] = reply(report, rank);
    free_at = std::max(free_at, at) + seconds;
    served += seconds;
    ++replies;
    last = std::max(last, at);
    report = {};
    if (lease.empty()) continue;
    for (const auto shard : lease) {
      report.seconds += cost(random);
      report.finished.push_back(line_of(shard));
    }
    worked += report.seconds;
    queue.push({free_at + report.seconds, rank});
  }
  return {worked / (last * workers), served / static_cast<double>(replies)};
}

std::deque<std::uint64_t> shards_for(int workers, double shard_seconds) {
  constexpr double kRunSeconds = 300.0;
  std::deque<std::uint64_t> all(static_cast<std::size_t>(kRunSeconds / shard_seconds * workers));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

Outcome of_the_master(int workers, double shard_seconds, double flush, double message,
                      double message_per_shard) {
  Progress progress(Progress::Mode::none, "draws", 1, 0);
  ranks::JournalKeeper keeper([&](std::span<const store::JournalLine>) {
    std::this_thread::sleep_for(std::chrono::duration<double>(flush));
  });
  ranks::Master master(MPI_COMM_SELF, keeper, progress, shards_for(workers, shard_seconds), workers, 0);
  return simulate(workers, shard_seconds, [&](ranks::Report& report, int rank) {
    const auto shards = static_cast<double>(report.finished.size());
    const auto start = Clock::now();
    ranks::Shards lease = master.exchange(report, rank);
    return std::pair(std::move(lease), since(start) + message + shards * message_per_shard);
  });
}

Outcome with_a_flush_in_each_reply(int workers, double shard_seconds, double flush, double message) {
  auto missing = shards_for(workers, shard_seconds);
  return simulate(workers, shard_seconds, [&](ranks::Report& report, int) {
    ranks::Shards lease;
    if (!missing.empty()) {
      lease.push_back(missing.front());
      missing.pop_front();
    }
    return std::pair(std::move(lease), message + (report.finished.empty() ? 0.0 : flush));
  });
}
}  // namespace

int main(int argc, char** argv) {
  ranks::MpiSession session(&argc, &argv);
  const double shard_seconds = argc > 1 ? std::atof(argv[1]) : 0.33;
  const double flush = argc > 2 ? std::atof(argv[2]) * 1e-3 : 0.020;
  const double one = message_cost(1), many = message_cost(33);
  const double per_shard = (many - one) / 32.0, message = one - per_shard;
  fmt::print("a shard takes {:g} s, a flush {:g} ms; a report costs {:.1f} us and {:.1f} us for each shard\n",
             shard_seconds, flush * 1e3, message * 1e6, per_shard * 1e6);
  fmt::print("{:>8} {:>14} {:>16} {:>34}\n", "workers", "busy, master", "us per reply",
             "busy, a flush in each reply");
  for (const int workers : {16, 64, 256, 1000, 10000}) {
    const Outcome now = of_the_master(workers, shard_seconds, flush, message, per_shard);
    const Outcome before = with_a_flush_in_each_reply(workers, shard_seconds, flush, one);
    fmt::print("{:>8} {:>13.1f}% {:>16.1f} {:>33.1f}%\n", workers, 100 * now.busy, now.per_reply * 1e6,
               100 * before.busy);
  }
}
