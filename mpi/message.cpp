#include "mpi/message.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

namespace swingbank {

std::string pack(const Report& r) {
  nlohmann::json j;
  j["stop"] = r.stop;
  if (r.finished) j["finished"] = journal_text(*r.finished);
  for (const auto& p : r.problems) j["problems"].push_back({p.what, p.where, p.why, p.remedy});
  return j.dump();
}

Report unpack(const std::string& text) {
  const auto j = nlohmann::json::parse(text);
  Report r;
  r.stop = j.at("stop");
  if (j.contains("finished")) r.finished = parse_journal_line(j["finished"]);
  if (j.contains("problems"))
    for (const auto& p : j["problems"]) r.problems.push_back({p[0], p[1], p[2], p[3]});
  return r;
}

bool wait_for(MPI_Comm world, int from, int tag, double timeout) {
  const double start = MPI_Wtime();
  for (;;) {
    int there = 0;
    MPI_Iprobe(from, tag, world, &there, MPI_STATUS_IGNORE);
    if (there != 0) return true;
    if (timeout > 0 && MPI_Wtime() - start > timeout) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace swingbank
