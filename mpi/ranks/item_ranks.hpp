#pragma once
// Implementation of the interface items::Ranks with MPI, for the ranks of a launcher.
#include <mpi.h>

#include "mpi/items/ranks.hpp"

namespace swingbank::mpi::ranks {

/// Ranks of a communicator.
class ItemRanks final : public items::Ranks {
 public:
  explicit ItemRanks(MPI_Comm world) : world_(world) {}
  [[nodiscard]] int rank() const override;
  [[nodiscard]] int size() const override;
  [[nodiscard]] int on_this_machine() const override;
  [[nodiscard]] int from_first(int value) const override;
  void copy_from_first(std::span<std::byte> bytes) const override;
  void sum(std::span<float> values) const override;
  void agree(const std::string& where, const std::function<void()>& prepare) const override;
  [[nodiscard]] bool share_items(const items::SharedItems& shared) const override;

 private:
  MPI_Comm world_;
};

}  // namespace swingbank::mpi::ranks
