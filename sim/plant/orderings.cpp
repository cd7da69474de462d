#include "sim/plant/orderings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace swingbank::sim::plant {
namespace {

/// Chains of names; names that an effect lacks are skipped. A machine without X''q uses X''d.
constexpr std::array<std::array<std::string_view, 4>, 5> kChains = {{{"Xd", "Xdp", "Xdpp", "Xl"},
                                                                     {"Xq", "Xqp", "Xqpp", "Xl"},
                                                                     {"Tdop", "Tdopp", "", ""},
                                                                     {"Tqop", "Tqopp", "", ""},
                                                                     {"S12", "S10", "", ""}}};

int index_of(const Effect& effect, std::string_view name) {
  if (name.empty()) return -1;
  const int own = effect.parameter_index(name);
  return own < 0 && name == "Xqpp" ? effect.parameter_index("Xdpp") : own;
}

/// Whether the machine has no X'q: with T'qo = 0, as for salient poles, it has no transient circuit in the q
/// axis.
bool is_absent(const Block& block, std::string_view name) {
  const int time = block.effect->parameter_index("Tqop");
  return name == "Xqp" && time >= 0 && block.p[static_cast<std::size_t>(time)] == 0;
}

}  // namespace

std::vector<Ordering> orderings(const Block& block) {
  std::vector<Ordering> list;
  if (block.effect->slot != Slot::machine) return list;
  for (const auto& chain : kChains) {
    int before = -1;
    for (const auto name : chain) {
      const int at = index_of(*block.effect, name);
      if (at < 0 || is_absent(block, name)) continue;
      if (before >= 0 && block.p[static_cast<std::size_t>(before)] > 0 &&
          block.p[static_cast<std::size_t>(at)] > 0)
        list.push_back({before, at, name == kChains.front().back()});
      before = at;
    }
  }
  return list;
}

std::vector<Ordering> violated(const Block& block) {
  std::vector<Ordering> list;
  for (const auto& o : orderings(block)) {
    const auto same = [&](const Ordering& other) {  // X''d may replace X''q
      return other.greater == o.greater && other.smaller == o.smaller;
    };
    if (!(block.p[static_cast<std::size_t>(o.greater)] > block.p[static_cast<std::size_t>(o.smaller)]) &&
        std::ranges::none_of(list, same))
      list.push_back(o);
  }
  return list;
}

std::string violation_text(const Block& block, const Ordering& ordering) {
  const auto text = [&](int i) {
    const Parameter& p = block.effect->parameters[static_cast<std::size_t>(i)];
    return fmt::format("{} = {:.4g} {}", p.symbol, block.p[static_cast<std::size_t>(i)], p.unit);
  };
  return text(ordering.greater) + " is not above " + text(ordering.smaller);
}

}  // namespace swingbank::sim::plant
