#include "mpi/draw/sampler.hpp"

#include "mpi/draw/detail/plant_blocks.hpp"
#include "mpi/draw/detail/random.hpp"

namespace swingbank::mpi::draw {

Draw Sampler::draw(std::uint64_t sample_id) {
  const DatasetConfig& c = study_.config;
  const std::uint64_t point = sample_id / c.fault.per_point, machines = study_.plants.size();
  Draw d;
  d.job.id = sample_id;
  if (c.vary == Vary::one) {
    d.recorded = {point % machines};
    d.points = {point};
  } else {
    for (std::size_t g = 0; g < machines; ++g) {
      d.recorded.push_back(g);
      d.points.push_back(point * machines + g);
    }
  }
  for (std::size_t i = 0; i < d.recorded.size(); ++i) {
    const int plant = study_.plants[d.recorded[i]];
    BoxedPlant boxed(c, study_.grid.plants[static_cast<std::size_t>(plant)]);
    boxed.set(bank_.point(d.points[i]));
    boxed.put_into(d.job, plant);
  }
  if (c.operating_point) {
    const OperatingPoint& operating = operating_.at(sample_id / c.operating_point->per_block);
    d.job.grid = operating.grid;
    d.redrawn = operating.redrawn;
  }
  Random random(c.seed, Stream::fault, sample_id);
  const int bus = study_.fault_buses[random.below(study_.fault_buses.size())];
  const double off = c.fault.start + random.uniform(c.fault.shortest, c.fault.longest);
  d.job.event.faults = {{bus, c.fault.start, off, {c.fault.r, c.fault.x}}};
  return d;
}

std::string Sampler::refusal(const Draw& draw) const {
  const sim::grid::Grid& grid = draw.job.grid ? *draw.job.grid : study_.grid;
  for (const auto& [index, plant] : sim::batch::changed_plants(study_.grid, draw.job)) {
    if (const auto why = objection(study_.config, plant); !why.empty()) return why;
    try {
      sim::plant::operating_point(plant, grid.flow.voltage[static_cast<std::size_t>(plant.bus)],
                                  grid.network.base_mva, grid.conventions);
    } catch (const InputError& e) {
      return e.what();
    }
  }
  return {};
}

}  // namespace swingbank::mpi::draw
