#pragma once
// What a group's leader tells the master each time it asks for shards, and how ranks wait without using a
// core.
#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "mpi/store/journal.hpp"

namespace swingbank::mpi::ranks {

constexpr int kReportTag = 1, kLeaseTag = 2, kAuditTag = 3;

struct Report {
  std::vector<store::JournalLine> finished;  ///< shards that it was leased, durable
  double seconds = 0.0;                      ///< that these took
  std::vector<Problem> problems;             ///< why it could not make the others
  bool stop = false;                         ///< a signal asked for a soft exit
};
/// A byte that is no UTF-8 (a path may have some) arrives as U+FFFD.
std::string pack(const Report& report);
Report unpack(const std::string& text);

void send_text(MPI_Comm world, int to, int tag, const std::string& text);
/// Waits for it without using the core.
std::string receive_text(MPI_Comm world, int from, int tag);

/// Waits for a message without using the core. Gives up after `timeout` seconds (0: never); false then.
bool wait_for(MPI_Comm world, int from, int tag, double timeout);
/// Until the operation is complete: at full load for the first 200 microseconds, then asleep between looks.
/// Gives up after `timeout` seconds (0: never); false then.
bool wait_for(MPI_Request request, double timeout = 0);

/// Shards of a lease, none where there is no more.
using Shards = std::vector<std::uint64_t>;
void send_shards(MPI_Comm world, int to, const Shards& shards);
Shards receive_shards(MPI_Comm world, int from);
/// From rank 0 of the group to all others.
void share_shards(MPI_Comm group, Shards& shards);

}  // namespace swingbank::mpi::ranks
