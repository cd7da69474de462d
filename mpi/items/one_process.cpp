#include "mpi/items/one_process.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "mpi/items/item_queue.hpp"

namespace swingbank::mpi::items {

bool OneProcess::share_items(const SharedItems& shared) const {
  ItemQueue queue(shared, [](const std::string& why) {
    fmt::print(stderr, "{}: the run ends; finished items are safe, run the command again to continue\n", why);
    std::_Exit(1);  // the working thread cannot be stopped
  });
  return queue.run([] { return false; });
}

}  // namespace swingbank::mpi::items
