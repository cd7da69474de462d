#include "mpi/ranks/item_ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <exception>

#include "base/stop_signal.hpp"
#include "mpi/items/item_queue.hpp"
#include "mpi/ranks/detail/message.hpp"
#include "mpi/ranks/shard_group.hpp"

namespace swingbank::mpi::ranks {
namespace {

constexpr int kFinishedTag = 11, kItemTag = 12;
constexpr std::int64_t kNone = -1;

/// Returns a rank's message to rank 0, "item stop result". Item -1: the rank has finished none yet.
std::string packed(std::int64_t item, const std::string& result) {
  return fmt::format("{} {} {}", item, stop_asked() ? 1 : 0, result);
}
struct RankMessage {
  std::int64_t item;
  bool stop;
  std::string result;
};
RankMessage unpacked(const std::string& text) {
  const auto first = text.find(' '), second = text.find(' ', first + 1);
  return {std::stoll(text.substr(0, first)), text[first + 1] == '1', text.substr(second + 1)};
}

/// Replies to the ranks that have sent a result, each with its next item. `others`: number of ranks that have
/// not received the end of the queue yet.
void reply(MPI_Comm world, items::ItemQueue& queue, int& others) {
  for (int there = 1; there != 0;) {
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kFinishedTag, world, &there, &status);
    if (there == 0) return;
    int length;
    MPI_Get_count(&status, MPI_CHAR, &length);
    std::string text(static_cast<std::size_t>(length), '\0');
    MPI_Recv(text.data(), length, MPI_CHAR, status.MPI_SOURCE, kFinishedTag, world, MPI_STATUS_IGNORE);
    const RankMessage message = unpacked(text);
    if (message.stop) queue.stop();
    const auto next = queue.next(status.MPI_SOURCE);
    const std::int64_t item = next ? static_cast<std::int64_t>(*next) : kNone;
    MPI_Send(&item, 1, MPI_INT64_T, status.MPI_SOURCE, kItemTag, world);
    if (item == kNone) --others;
    if (message.item != kNone) queue.finish(static_cast<std::size_t>(message.item), message.result);
  }
}

/// Distributes the items on rank 0. Returns whether all are done.
bool distribute(MPI_Comm world, int size, const items::SharedItems& shared) {
  items::ItemQueue queue(shared, [](const std::string& why) { end_all_ranks(why.c_str()); });
  int others = size - 1;
  return queue.run([&] {
    if (others > 0) reply(world, queue, others);
    return others > 0;
  });
}

/// Work loop of the other ranks: sends each result and receives the next item, until none is left.
void take_until_none(MPI_Comm world, const items::SharedItems& shared) {
  std::string text = packed(kNone, "");
  for (;;) {
    MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, 0, kFinishedTag, world);
    wait_for(world, 0, kItemTag, 0);
    std::int64_t item;
    MPI_Recv(&item, 1, MPI_INT64_T, 0, kItemTag, world, MPI_STATUS_IGNORE);
    if (item == kNone) return;
    text = packed(item, shared.work(static_cast<std::size_t>(item)));
  }
}

}  // namespace

int ItemRanks::rank() const {
  int r;
  MPI_Comm_rank(world_, &r);
  return r;
}
int ItemRanks::size() const {
  int n;
  MPI_Comm_size(world_, &n);
  return n;
}
int ItemRanks::on_this_machine() const {
  MPI_Comm here;
  MPI_Comm_split_type(world_, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  int n;
  MPI_Comm_size(here, &n);
  MPI_Comm_free(&here);
  return n;
}
int ItemRanks::from_first(int value) const {
  MPI_Bcast(&value, 1, MPI_INT, 0, world_);
  return value;
}

namespace {
/// Calls `work` for consecutive parts of at most 2^28 elements, because MPI's counts are of type `int`.
template <class Element, class Work>
void in_parts(std::span<Element> all, const Work& work) {
  constexpr std::size_t kMostAtOnce = std::size_t{1} << 28;
  for (std::size_t at = 0; at < all.size(); at += kMostAtOnce) {
    const auto part = all.subspan(at, std::min(kMostAtOnce, all.size() - at));
    work(part.data(), static_cast<int>(part.size()));
  }
}
}  // namespace

void ItemRanks::copy_from_first(std::span<std::byte> bytes) const {
  in_parts(bytes, [&](std::byte* data, int count) { MPI_Bcast(data, count, MPI_BYTE, 0, world_); });
}
void ItemRanks::sum(std::span<float> values) const {
  in_parts(values, [&](float* data, int count) {
    MPI_Allreduce(MPI_IN_PLACE, data, count, MPI_FLOAT, MPI_SUM, world_);
  });
}

void ItemRanks::agree(const std::string& where, const std::function<void()>& prepare) const {
  ranks::agree(world_, where, prepare);
}

bool ItemRanks::share_items(const items::SharedItems& shared) const {
  try {
    bool complete = false;
    if (rank() == 0)
      complete = distribute(world_, size(), shared);
    else
      take_until_none(world_, shared);
    return from_first(complete ? 1 : 0) != 0;
  } catch (const std::exception& error) {
    if (size() == 1) throw;
    end_all_ranks(error.what());  // the other ranks would wait forever
  }
}

}  // namespace swingbank::mpi::ranks
