#include "train/soft_exit.hpp"

#include <csignal>

namespace swingbank {
namespace {
volatile std::sig_atomic_t requested = 0;
extern "C" void note_request(int) { requested = 1; }
}  // namespace

void catch_soft_exit() {
  std::signal(SIGUSR1, note_request);
  std::signal(SIGTERM, note_request);
}
bool soft_exit_requested() { return requested != 0; }

}  // namespace swingbank
