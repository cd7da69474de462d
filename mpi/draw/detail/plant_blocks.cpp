#include "mpi/draw/detail/plant_blocks.hpp"

#include <algorithm>

namespace swingbank::mpi::draw {

std::size_t block_count(const sim::plant::Plant& plant, const sim::Effect& effect) {
  const auto same = [&](const sim::plant::Block& b) { return b.effect == &effect; };
  return static_cast<std::size_t>(std::ranges::count_if(plant.controls, same)) +
         (same(plant.transformer) ? 1 : 0);
}

namespace {
std::string objection_to(const sim::plant::Block& block, Policy policy) {
  Problems problems;
  block.effect->check(block.effect->law.get(), block.p.data(), "draw", problems);
  if (policy == Policy::physical)
    if (const auto why = block.effect->unphysical(block.p.data()); !why.empty())
      return "not " + std::string(why);
  return problems.empty() ? "" : "singular: " + problems.list().front().why;
}
}  // namespace

std::string objection(const DatasetConfig& config, const sim::plant::Plant& plant) {
  std::string why = objection_to(plant.machine, config.databank.policy);
  const auto judge = [&](const sim::plant::Block& block) {
    const auto its = [&](const Box& b) { return b.effect != nullptr && b.effect == block.effect; };
    if (why.empty() && std::ranges::any_of(config.box, its))
      why = objection_to(block, config.databank.policy);
  };
  judge(plant.transformer);
  std::ranges::for_each(plant.controls, judge);
  return why;
}

BoxedPlant::BoxedPlant(const DatasetConfig& config, const sim::plant::Plant& plant) : plant_(plant) {
  const auto place_of = [&](const sim::Effect* effect) -> sim::plant::Block& {
    if (effect == nullptr) return plant_.machine;
    if (plant_.transformer.effect == effect) return plant_.transformer;
    return *std::ranges::find(plant_.controls, effect, &sim::plant::Block::effect);
  };
  for (const auto& b : config.box)
    values_.push_back(&place_of(b.effect).p[static_cast<std::size_t>(b.index)]);
  for (const sim::Effect* effect : config.other_effects()) {
    const sim::plant::Block& block = place_of(effect);
    changed_.push_back({&block == &plant_.transformer ? sim::lanes::kTransformer
                                                      : static_cast<int>(&block - plant_.controls.data()),
                        &block});
  }
}

void BoxedPlant::set(const double* x) {
  for (double* value : values_) *value = *x++;
}

void BoxedPlant::put_into(sim::lanes::Job& job, int index) const {
  job.machine_parameters.emplace_back(index, plant_.machine.p);
  for (const auto& c : changed_) job.control_parameters.push_back({index, c.control, c.block->p});
}

}  // namespace swingbank::mpi::draw
