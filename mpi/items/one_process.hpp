#pragma once
// This process alone as the only rank, without MPI.
#include "mpi/items/ranks.hpp"

namespace swingbank::mpi::items {

/// The only rank of a run.
class OneProcess final : public Ranks {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int size() const override { return 1; }
  [[nodiscard]] int on_this_machine() const override { return 1; }
  [[nodiscard]] int from_first(int value) const override { return value; }
  void copy_from_first(std::span<std::byte>) const override {}
  void sum(std::span<float>) const override {}
  void agree(const std::string&, const std::function<void()>& prepare) const override { prepare(); }
  [[nodiscard]] bool share_items(const SharedItems& shared) const override;
};

}  // namespace swingbank::mpi::items
