#include "sim/reference/detail/nonzeros.hpp"

namespace swingbank::sim::reference {

Nonzeros::Nonzeros(const ReferenceSystem& system, SeenEntries& seen)
    : system_(system),
      full_pattern_(system.pattern()),
      seen_(seen),
      taken_(static_cast<std::size_t>(system.pattern().nonZeros()), 0) {}

bool Nonzeros::take(const std::vector<double>& values) {
  int fresh = 0;
  for (std::size_t i = 0; i < taken_.size(); ++i)
    fresh += static_cast<int>(values[i] != 0.0) & (taken_[i] == 0 ? 1 : 0);
  if (fresh == 0 && !outer_.empty()) return false;
  for (std::size_t i = 0; i < taken_.size(); ++i) taken_[i] = taken_[i] != 0 || values[i] != 0.0;
  const auto& units = system_.units();
  for (std::size_t u = 0; u < units.size(); ++u) {
    const auto& places = system_.places(u);
    const auto kind = static_cast<std::size_t>(units[u].kind);
    if (seen_.size() <= kind) seen_.resize(kind + 1);
    seen_[kind].resize(places.size(), 0);
    for (std::size_t k = 0; k < places.size(); ++k)
      if (places[k] >= 0 && taken_[static_cast<std::size_t>(places[k])] != 0) seen_[kind][k] = 1;
  }
  for (std::size_t u = 0; u < units.size(); ++u) {
    const auto& places = system_.places(u);
    const auto& seen = seen_[static_cast<std::size_t>(units[u].kind)];
    for (std::size_t k = 0; k < places.size(); ++k)
      if (places[k] >= 0 && seen[k] != 0) taken_[static_cast<std::size_t>(places[k])] = 1;
  }
  kept_.clear();
  outer_.assign(1, 0);
  for (int column = 0; column < full_pattern_.cols(); ++column) {
    for (int i = full_pattern_.outerIndexPtr()[column]; i < full_pattern_.outerIndexPtr()[column + 1]; ++i)
      if (taken_[static_cast<std::size_t>(i)] != 0) kept_.push_back(i);
    outer_.push_back(count());
  }
  return true;
}

}  // namespace swingbank::sim::reference
