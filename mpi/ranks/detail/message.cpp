#include "mpi/ranks/detail/message.hpp"

#include <chrono>
#include <thread>

#include "base/json.hpp"

namespace swingbank::mpi::ranks {

std::string pack(const Report& r) {
  nlohmann::json j;
  j["stop"] = r.stop;
  j["seconds"] = r.seconds;
  for (const auto& line : r.finished) j["finished"].push_back(store::journal_text(line));
  for (const auto& p : r.problems) j["problems"].push_back({p.what, p.where, p.why, p.remedy});
  return json_text(j);
}

Report unpack(const std::string& text) {
  const auto j = nlohmann::json::parse(text);
  Report r;
  r.stop = j.at("stop");
  r.seconds = j.at("seconds");
  if (j.contains("finished"))
    for (const auto& line : j["finished"]) r.finished.push_back(store::parse_journal_line(line));
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

bool wait_for(MPI_Request request, double timeout) {
  constexpr double kAwake = 200e-6;  // time of busy polling [s], above that of a reduction in a group
  const double start = MPI_Wtime();
  for (int done = 0;;) {
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    if (done != 0) return true;
    if (timeout > 0 && MPI_Wtime() - start > timeout) return false;
    if (MPI_Wtime() - start > kAwake) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void send_shards(MPI_Comm world, int to, const Shards& shards) {
  MPI_Send(shards.data(), static_cast<int>(shards.size()), MPI_UINT64_T, to, kLeaseTag, world);
}

Shards receive_shards(MPI_Comm world, int from) {
  MPI_Status status;
  MPI_Probe(from, kLeaseTag, world, &status);
  int count;
  MPI_Get_count(&status, MPI_UINT64_T, &count);
  Shards shards(static_cast<std::size_t>(count));
  MPI_Recv(shards.data(), count, MPI_UINT64_T, from, kLeaseTag, world, MPI_STATUS_IGNORE);
  return shards;
}

void share_shards(MPI_Comm group, Shards& shards) {
  MPI_Request request;
  std::uint64_t count = shards.size();
  MPI_Ibcast(&count, 1, MPI_UINT64_T, 0, group, &request);
  wait_for(request);
  shards.resize(count);
  MPI_Bcast(shards.data(), static_cast<int>(count), MPI_UINT64_T, 0, group);
}

}  // namespace swingbank::mpi::ranks
