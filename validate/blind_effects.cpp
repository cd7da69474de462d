#include "validate/blind_effects.hpp"

#include "sim/core/library.hpp"
#include "sim/solve/block_text.hpp"

namespace swingbank::validate {

const sim::Effect* blind_effect(const std::string& name) {
  for (const auto& odd : odd_effects())
    if (odd.name == name) return &odd;
  return sim::find_effect(name);
}

sim::Block blind_block(const std::string& text, const std::string& where, Problems& problems) {
  const auto colon = text.find(':');
  sim::Block block{blind_effect(text.substr(0, colon)), {}};
  if (!block.effect) {
    problems.add("no effect '" + text.substr(0, colon) + "'", where, "there are " + sim::effect_names(),
                 "choose one of these");
    return {};
  }
  block.p = block.effect->standard_parameters();
  if (colon != text.npos) sim::set_parameters(block, text.substr(colon + 1), where, problems);
  return block;
}

}  // namespace swingbank::validate
