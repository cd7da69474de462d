#include "sim/library/variants.hpp"

#include <utility>

#include "sim/library/library.hpp"

namespace swingbank::sim::library {

/// Returns, per compiled effect, its name and the name of the effect that it varies, or "". Generated.
std::span<const std::pair<std::string_view, std::string_view>> variants();

const Effect* variant_of(const Effect& effect) {
  for (const auto& [name, other] : variants())
    if (name == effect.name) return other.empty() ? nullptr : compiled().find(other);
  return nullptr;
}

}  // namespace swingbank::sim::library
