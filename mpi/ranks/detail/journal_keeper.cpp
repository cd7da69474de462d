#include "mpi/ranks/detail/journal_keeper.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace swingbank::mpi::ranks {

JournalKeeper::JournalKeeper(Append append) : append_(std::move(append)), thread_([this] { run(); }) {}

JournalKeeper::~JournalKeeper() { finish(); }

void JournalKeeper::put(std::vector<store::JournalLine> lines) {
  {
    const std::lock_guard guard(mutex_);
    std::ranges::move(lines, std::back_inserter(waiting_));
  }
  wake_.notify_one();
}

void JournalKeeper::finish() {
  {
    const std::lock_guard guard(mutex_);
    ending_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

std::vector<Problem> JournalKeeper::problems() const {
  const std::lock_guard guard(mutex_);
  return problems_;
}

void JournalKeeper::run() {
  std::unique_lock guard(mutex_);
  for (;;) {
    wake_.wait(guard, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const auto lines = std::exchange(waiting_, {});
    if (!problems_.empty()) continue;
    guard.unlock();
    std::vector<Problem> problems;
    try {
      append_(lines);
    } catch (const InputError& e) {
      problems = e.problems();
    } catch (const std::exception& e) {
      problems = {{"cannot write the journal", "dataset", e.what(), "run the command again: it continues"}};
    }
    guard.lock();
    problems_ = std::move(problems);
  }
}

}  // namespace swingbank::mpi::ranks
