#include "research/blind/cases/detail/effects.hpp"

#include "sim/library/library.hpp"
#include "sim/plant/block_text.hpp"

namespace swingbank::research::blind::cases {

const sim::Effect* blind_effect(const std::string& name) {
  for (const auto& unlisted : unlisted_effects())
    if (unlisted.name == name) return &unlisted;
  return sim::library::compiled().find(name);
}

sim::plant::Block blind_block(const std::string& text, const std::string& where, Problems& problems) {
  const auto colon = text.find(':');
  sim::plant::Block block{blind_effect(text.substr(0, colon)), {}};
  if (!block.effect) {
    problems.add("unknown effect '" + text.substr(0, colon) + "'", where,
                 "there are " + sim::library::compiled().names(), "choose one of these");
    return {};
  }
  block.p = block.effect->default_parameters();
  if (colon != text.npos) sim::plant::set_parameters(block, text.substr(colon + 1), where, problems);
  return block;
}

}  // namespace swingbank::research::blind::cases
