#pragma once
// What a group's leader tells the master each time it asks for a shard.
#include <mpi.h>

#include <optional>
#include <string>
#include <vector>

#include "mpi/store/journal.hpp"
#include "sim/core/problem.hpp"

namespace swingbank {

constexpr int kReportTag = 1, kLeaseTag = 2;
constexpr std::int64_t kNoMore = -1;

struct Report {
  std::optional<JournalLine> finished;  ///< the shard it was leased, durable
  std::vector<Problem> problems;        ///< why it could not make the shard
  bool stop = false;                    ///< a signal asked for a soft exit
};
std::string pack(const Report& report);
Report unpack(const std::string& text);

/// Waits for a message without using the core. Gives up after `timeout` seconds (0: never); false then.
bool wait_for(MPI_Comm world, int from, int tag, double timeout);

}  // namespace swingbank
