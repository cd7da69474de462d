#include "mpi/ranks/detail/message.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

namespace swingbank::mpi::ranks {

std::string pack(const Report& r) {
  nlohmann::json j;
  j["stop"] = r.stop;
  if (r.finished) j["finished"] = store::journal_text(*r.finished);
  for (const auto& p : r.problems) j["problems"].push_back({p.what, p.where, p.why, p.remedy});
  return j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Report unpack(const std::string& text) {
  const auto j = nlohmann::json::parse(text);
  Report r;
  r.stop = j.at("stop");
  if (j.contains("finished")) r.finished = store::parse_journal_line(j["finished"]);
  if (j.contains("problems"))
    for (const auto& p : j["problems"]) r.problems.push_back({p[0], p[1], p[2], p[3]});
  return r;
}

void send_text(MPI_Comm world, int to, int tag, const std::string& text) {
  MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, to, tag, world);
}

std::string receive_text(MPI_Comm world, int from, int tag) {
  wait_for(world, from, tag, 0);
  MPI_Status status;
  MPI_Probe(from, tag, world, &status);
  int length;
  MPI_Get_count(&status, MPI_CHAR, &length);
  std::string text(static_cast<std::size_t>(length), '\0');
  MPI_Recv(text.data(), length, MPI_CHAR, from, tag, world, MPI_STATUS_IGNORE);
  return text;
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

}  // namespace swingbank::mpi::ranks
