#include "mpi/draw/detail/plant_blocks.hpp"

#include <algorithm>

namespace swingbank::mpi::draw {

int times_in(const sim::plant::Plant& plant, const sim::Effect& effect) {
  int count = 0;
  for (int block = sim::plant::kMachineBlock + 1; block < sim::plant::first_measurement(plant); ++block)
    if (&sim::plant::block_effect(plant, block) == &effect) ++count;
  return count;
}

namespace {
std::string objection_to(const sim::plant::Block& block, Policy policy) {
  if (policy == Policy::physical)  // first: it rejects most samples, and `check` (which formats text) is slow
    if (const auto why = block.effect->unphysical(block.p.data()); !why.empty())
      return "not " + std::string(why);
  Problems problems;
  block.effect->check(block.effect->user_model.get(), block.p.data(), "draw", problems);
  return problems.empty() ? "" : "singular: " + problems.list().front().why;
}
}  // namespace

std::string objection(const DatasetConfig& config, const sim::plant::Plant& plant) {
  std::string why = objection_to(plant.machine, config.databank.policy);
  const auto judge = [&](const sim::plant::Block& block) {
    const auto its = [&](const Box& b) { return b.effect == block.effect; };
    if (why.empty() && std::ranges::any_of(config.box, its))
      why = objection_to(block, config.databank.policy);
  };
  for (int block = sim::plant::kMachineBlock + 1; block < sim::plant::first_measurement(plant); ++block)
    judge(sim::plant::block_at(plant, block));
  return why;
}

BoxedPlant::BoxedPlant(const DatasetConfig& config, const sim::plant::Plant& plant) : plant_(plant) {
  const auto block_of = [&](const sim::Effect* effect) {
    return effect == nullptr ? sim::plant::kMachineBlock : sim::plant::find_block(plant_, *effect).value();
  };
  for (const auto& b : config.box) boxed_.push_back({block_of(b.effect), b.index});
  for (const sim::Effect* effect : config.other_effects()) changed_.push_back(block_of(effect));
}

void BoxedPlant::set(const double* x) {
  for (const sim::plant::ParameterId id : boxed_) sim::plant::parameter_value(plant_, id) = *x++;
}

void BoxedPlant::put_into(sim::batch::Job& job, int index) const {
  for (const int block : changed_)
    job.parameters.push_back({index, block, sim::plant::block_at(plant_, block).p});
}

}  // namespace swingbank::mpi::draw
