#pragma once
// A list of jobs in one batch, and what each gave.
#include <cstdint>
#include <map>
#include <vector>

#include "sim/lanes/batch.hpp"

namespace swingbank::sim::lanes {

inline std::map<std::uint64_t, Trajectory> run_jobs(const grid::Grid& grid, const std::vector<Job>& jobs,
                                                    const BatchOptions& options) {
  Batch batch(grid, options);
  std::map<std::uint64_t, Trajectory> all;
  std::size_t at = 0;
  batch.run([&](Job& job) { return at < jobs.size() && (job = jobs[at++], true); },
            [&](const Job& job, const Trajectory& t) { all[job.id] = t; });
  return all;
}

}  // namespace swingbank::sim::lanes
