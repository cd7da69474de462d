#pragma once
// Messages between group leaders and the master, and functions that wait for messages without busy polling.
#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "mpi/store/journal.hpp"

namespace swingbank::mpi::ranks {

constexpr int kReportTag = 1, kLeaseTag = 2, kAuditTag = 3;

/// Report of a group leader on its lease; it is also the request for the next lease.
struct Report {
  std::vector<store::JournalLine> finished;  ///< finished shards of the lease, already on disk
  double seconds = 0.0;                      ///< time for these shards [s]
  std::vector<Problem> problems;             ///< reasons why other shards failed
  bool stop = false;                         ///< whether the group has received a stop signal
};
/// Returns a report as text. Bytes that are not UTF-8 (a path may contain some) become U+FFFD.
std::string pack(const Report& report);
Report unpack(const std::string& text);

void send_text(MPI_Comm world, int to, int tag, const std::string& text);
/// Waits for a text without busy polling and returns it.
std::string receive_text(MPI_Comm world, int from, int tag);

/// Waits for a message, sleeping between polls. Returns false after `timeout` [s]; 0: no timeout.
bool wait_for(MPI_Comm world, int from, int tag, double timeout);
/// Waits until the operation is complete: polls continuously for 200 microseconds, then sleeps between polls.
/// Returns false after `timeout` [s]; 0: no timeout.
bool wait_for(MPI_Request request, double timeout = 0);

/// Shards of a lease; empty if none are missing.
using Shards = std::vector<std::uint64_t>;
void send_shards(MPI_Comm world, int to, const Shards& shards);
Shards receive_shards(MPI_Comm world, int from);
/// Broadcasts the lease from rank 0 of the group.
void share_shards(MPI_Comm group, Shards& shards);

}  // namespace swingbank::mpi::ranks
