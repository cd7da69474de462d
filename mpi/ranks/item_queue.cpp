#include "mpi/ranks/item_queue.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <exception>
#include <map>
#include <optional>
#include <thread>

#include "base/stop_signal.hpp"
#include "mpi/ranks/detail/message.hpp"
#include "mpi/ranks/shard_group.hpp"

namespace swingbank::mpi::ranks {
namespace {

constexpr int kFinishedTag = 11, kItemTag = 12;
constexpr std::int64_t kNone = -1;
constexpr auto kPause = std::chrono::milliseconds(2);  // polling interval; items take seconds

/// Returns a rank's message to rank 0, "item stop result"; item -1: none finished yet.
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

/// Thread of rank 0 that processes one item at a time while rank 0 replies to the other ranks.
class OwnHand {
 public:
  explicit OwnHand(const SharedItems& shared) : thread_([this, &shared] { run(shared); }) {}
  ~OwnHand() {
    end_ = true;
    thread_.join();
  }
  OwnHand(const OwnHand&) = delete;
  OwnHand& operator=(const OwnHand&) = delete;
  [[nodiscard]] bool idle() const { return state_ == State::idle; }
  void give(std::size_t item) {
    item_ = item;
    state_ = State::working;
  }
  /// Returns the item finished since the last call, if any. Rethrows an exception of the work.
  std::optional<std::pair<std::size_t, std::string>> finished() {
    if (state_ != State::finished) return {};
    if (failure_) std::rethrow_exception(failure_);
    std::pair out(item_, std::move(result_));
    state_ = State::idle;
    return out;
  }

 private:
  enum class State { idle, working, finished };
  void run(const SharedItems& shared) {
    while (!end_) {
      if (state_ == State::working) {
        try {
          result_ = shared.work(item_);
        } catch (...) {
          failure_ = std::current_exception();
        }
        state_ = State::finished;
      }
      std::this_thread::sleep_for(kPause);
    }
  }
  std::atomic<State> state_ = State::idle;
  std::atomic<bool> end_ = false;
  std::size_t item_ = 0;  // owner of this and the next two members: the thread while state_ is `working`
  std::string result_;
  std::exception_ptr failure_;
  std::thread thread_;  // last member, because it uses the others
};

[[noreturn]] void give_up(const Ranks& ranks, const std::string& why) {
  if (ranks.world != MPI_COMM_NULL) ranks::end_all_ranks(why.c_str());
  fmt::print(stderr, "{}: the run ends; what is finished is safe, run the command again to continue\n", why);
  std::_Exit(1);  // the working thread cannot be stopped
}

/// Distributor on rank 0: gives items to the other ranks and to its own thread until all are done.
class Giver {
 public:
  Giver(const Ranks& ranks, const SharedItems& shared)
      : ranks_(ranks), shared_(shared), left_(shared.items.begin(), shared.items.end()), hand_(shared) {}
  bool run() {
    int others = ranks_.size() - 1;
    while (others > 0 || !hand_.idle() || (!left_.empty() && !stop_)) {
      stop_ = stop_ || stop_asked();
      if (ranks_.size() > 1) reply(others);
      end_if_overdue();
      if (auto own = hand_.finished()) finish(own->first, own->second);
      if (hand_.idle())
        if (const auto item = next(0); item != kNone) hand_.give(static_cast<std::size_t>(item));
      std::this_thread::sleep_for(kPause);
    }
    return done_ == shared_.items.size();
  }

 private:
  std::int64_t next(int rank) {
    out_.erase(rank);
    if (left_.empty() || stop_) return kNone;
    const std::size_t item = left_.front();
    left_.pop_front();
    out_[rank] = {item, Clock::now()};
    return static_cast<std::int64_t>(item);
  }
  /// Ends the run if an item is over its time limit, the only sign of a hanging rank.
  void end_if_overdue() const {
    if (shared_.limit <= 0.0) return;
    for (const auto& [rank, given] : out_) {
      const double age = std::chrono::duration<double>(Clock::now() - given.since).count();
      if (age > shared_.limit)
        give_up(ranks_, fmt::format("{} takes longer than {:g} s at rank {}", shared_.name(given.item),
                                    shared_.limit, rank));
    }
  }
  void finish(std::size_t item, const std::string& result) {
    ++done_;
    shared_.done(item, result);
  }
  void reply(int& others) {
    for (int there = 1; there != 0;) {
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, kFinishedTag, ranks_.world, &there, &status);
      if (there == 0) return;
      int length;
      MPI_Get_count(&status, MPI_CHAR, &length);
      std::string text(static_cast<std::size_t>(length), '\0');
      MPI_Recv(text.data(), length, MPI_CHAR, status.MPI_SOURCE, kFinishedTag, ranks_.world,
               MPI_STATUS_IGNORE);
      const RankMessage message = unpacked(text);
      stop_ = stop_ || message.stop;
      std::int64_t item = next(status.MPI_SOURCE);
      MPI_Send(&item, 1, MPI_INT64_T, status.MPI_SOURCE, kItemTag, ranks_.world);
      if (item == kNone) --others;
      if (message.item != kNone) finish(static_cast<std::size_t>(message.item), message.result);
    }
  }

  const Ranks& ranks_;
  const SharedItems& shared_;
  std::deque<std::size_t> left_;
  using Clock = std::chrono::steady_clock;
  struct Given {
    std::size_t item;
    Clock::time_point since;
  };
  std::map<int, Given> out_;  ///< items in progress by rank
  OwnHand hand_;
  std::size_t done_ = 0;
  bool stop_ = false;
};

/// Loop of the other ranks: sends each result and receives the next item, until none is left.
void take_until_none(const Ranks& ranks, const SharedItems& shared) {
  std::string text = packed(kNone, "");
  for (;;) {
    MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, 0, kFinishedTag, ranks.world);
    wait_for(ranks.world, 0, kItemTag, 0);
    std::int64_t item;
    MPI_Recv(&item, 1, MPI_INT64_T, 0, kItemTag, ranks.world, MPI_STATUS_IGNORE);
    if (item == kNone) return;
    text = packed(item, shared.work(static_cast<std::size_t>(item)));
  }
}

}  // namespace

int Ranks::rank() const {
  int r = 0;
  if (world != MPI_COMM_NULL) MPI_Comm_rank(world, &r);
  return r;
}
int Ranks::size() const {
  int n = 1;
  if (world != MPI_COMM_NULL) MPI_Comm_size(world, &n);
  return n;
}
int Ranks::on_this_machine() const {
  if (world == MPI_COMM_NULL) return 1;
  MPI_Comm here;
  MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  int n;
  MPI_Comm_size(here, &n);
  MPI_Comm_free(&here);
  return n;
}
int Ranks::from_first(int value) const {
  if (world != MPI_COMM_NULL) MPI_Bcast(&value, 1, MPI_INT, 0, world);
  return value;
}

void agree(const Ranks& ranks, const std::string& where, const std::function<void()>& prepare) {
  if (ranks.world == MPI_COMM_NULL)
    prepare();
  else
    agree(ranks.world, where, prepare);
}

bool share_items(const Ranks& ranks, const SharedItems& shared) {
  try {
    bool complete = false;
    if (ranks.rank() == 0)
      complete = Giver(ranks, shared).run();
    else
      take_until_none(ranks, shared);
    return ranks.from_first(complete ? 1 : 0) != 0;
  } catch (const std::exception& error) {
    if (ranks.size() == 1) throw;
    end_all_ranks(error.what());  // the others would wait forever
  }
}

}  // namespace swingbank::mpi::ranks
