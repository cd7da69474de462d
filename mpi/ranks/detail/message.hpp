#pragma once
// What a group's leader tells the master each time it asks for a shard.
#include <mpi.h>

#include <optional>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "mpi/store/journal.hpp"

namespace swingbank::mpi::ranks {

constexpr int kReportTag = 1, kLeaseTag = 2, kAuditTag = 3;
constexpr std::int64_t kNoMore = -1;

struct Report {
  std::optional<store::JournalLine> finished;  ///< the shard it was leased, durable
  std::vector<Problem> problems;               ///< why it could not make the shard
  bool stop = false;                           ///< a signal asked for a soft exit
};
/// A byte that is no UTF-8 (a path may have some) arrives as U+FFFD.
std::string pack(const Report& report);
Report unpack(const std::string& text);

void send_text(MPI_Comm world, int to, int tag, const std::string& text);
/// Waits for it without using the core.
std::string receive_text(MPI_Comm world, int from, int tag);

/// Waits for a message without using the core. Gives up after `timeout` seconds (0: never); false then.
bool wait_for(MPI_Comm world, int from, int tag, double timeout);

}  // namespace swingbank::mpi::ranks
