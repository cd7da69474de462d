#pragma once
// Runs a list of jobs in one batch and returns the results.
#include <cstdint>
#include <map>
#include <vector>

#include "sim/batch/batch.hpp"

namespace swingbank::sim::batch {

inline std::map<std::uint64_t, Trajectory> run_jobs(const grid::Grid& grid, const std::vector<Job>& jobs,
                                                    const BatchOptions& options) {
  Batch batch(grid, options);
  std::map<std::uint64_t, Trajectory> all;
  std::size_t at = 0;
  batch.run([&](Job& job) { return at < jobs.size() && (job = jobs[at++], true); },
            [&](const Job& job, const Trajectory& t) { all[job.id] = t; });
  return all;
}

/// Runs the events in one batch; the key of a result is the index of its event.
inline std::map<std::uint64_t, Trajectory> run_events(const grid::Grid& grid,
                                                      const std::vector<network::Event>& events,
                                                      const BatchOptions& options) {
  std::vector<Job> jobs(events.size());
  for (std::size_t e = 0; e < events.size(); ++e) jobs[e].id = e, jobs[e].event = events[e];
  return run_jobs(grid, jobs, options);
}

}  // namespace swingbank::sim::batch
