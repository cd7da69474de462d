#include "mpi/items/item_queue.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

#include "base/stop_signal.hpp"

namespace swingbank::mpi::items {
namespace {
using Clock = std::chrono::steady_clock;
constexpr auto kPause = std::chrono::milliseconds(2);  // polling interval; items take seconds
}  // namespace

/// Thread of rank 0 that processes one item at a time while rank 0 replies to the other ranks.
class OwnThread {
 public:
  explicit OwnThread(const SharedItems& shared) : thread_([this, &shared] { run(shared); }) {}
  ~OwnThread() {
    end_ = true;
    thread_.join();
  }
  OwnThread(const OwnThread&) = delete;
  OwnThread& operator=(const OwnThread&) = delete;
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
  std::size_t item_ = 0;  // this and the next two members belong to the thread while state_ is `working`
  std::string result_;
  std::exception_ptr failure_;
  std::thread thread_;  // last member, because it uses the others
};

ItemQueue::ItemQueue(const SharedItems& shared, std::function<void(const std::string&)> end_run)
    : shared_(shared),
      end_run_(std::move(end_run)),
      left_(shared.items.begin(), shared.items.end()),
      thread_(std::make_unique<OwnThread>(shared)) {}

ItemQueue::~ItemQueue() = default;

bool ItemQueue::run(const std::function<bool()>& serve) {
  for (;;) {
    stop_ = stop_ || stop_asked();
    const bool others_work = serve();
    end_if_overdue();
    if (auto own = thread_->finished()) finish(own->first, own->second);
    if (thread_->idle()) {
      if (const auto item = next(0))
        thread_->give(*item);
      else if (!others_work)
        return done_ == shared_.items.size();
    }
    std::this_thread::sleep_for(kPause);
  }
}

std::optional<std::size_t> ItemQueue::next(int rank) {
  given_.erase(rank);
  if (left_.empty() || stop_) return {};
  const std::size_t item = left_.front();
  left_.pop_front();
  given_.emplace(rank, Given{item, Clock::now()});
  return item;
}

void ItemQueue::finish(std::size_t item, const std::string& result) {
  ++done_;
  shared_.done(item, result);
}

/// Ends the run if an item exceeds its time limit. A hanging rank gives no other sign.
void ItemQueue::end_if_overdue() const {
  if (shared_.limit <= 0.0) return;
  for (const auto& [rank, given] : given_) {
    const double age = std::chrono::duration<double>(Clock::now() - given.since).count();
    if (age > shared_.limit)
      end_run_(fmt::format("{} took longer than the limit of {:g} s at rank {}", shared_.name(given.item),
                           shared_.limit, rank));
  }
}

}  // namespace swingbank::mpi::items
