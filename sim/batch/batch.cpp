#include "sim/batch/batch.hpp"

#include <fmt/format.h>

#include "sim/batch/detail/batch_kernel.hpp"

namespace swingbank::sim::batch {

namespace {
constexpr std::string_view instruction_set() {
#if defined(__AVX512F__)
  return "avx512";
#elif defined(__AVX2__)
  return "avx2";
#else
  return "baseline";
#endif
}
constexpr int widest() { return kRegisterBytes == 64 ? 8 : 4; }
}  // namespace

namespace detail {
struct Engine {
  virtual ~Engine() = default;
  virtual void run(const std::function<bool(Job&)>& next,
                   const std::function<void(const Job&, const Trajectory&)>& done) = 0;
};
template <class T>
struct EngineOf final : Engine {
  EngineOf(const grid::Grid& grid, const BatchOptions& options) : kernel(grid, options) {}
  void run(const std::function<bool(Job&)>& next,
           const std::function<void(const Job&, const Trajectory&)>& done) override {
    kernel.run(next, done);
  }
  BatchKernel<T> kernel;
};
}  // namespace detail

namespace {
/// Refuses effects that cannot run in single precision: user-defined models, and sources that need Newton's
/// method (algebra.hpp). Single precision cannot represent the tolerance of Newton's method, 1e-13 pu.
void refuse_in_float(const grid::Grid& grid) {
  Problems problems;
  const auto refuse = [&](const std::string& what, const std::string& why) {
    problems.add(what + " cannot run in single precision", "option lanes", why, "choose 8 lanes, or 0");
  };
  for (const plant::Plant& plant : grid.plants) {
    const Effect& machine = *plant.machine.effect;
    if (machine.get<double>().machine.current != nullptr)
      refuse(fmt::format("{} at {}", machine.name, plant.name),
             "its current is not a linear function of the voltage");
    std::vector<const Effect*> effects{&machine};
    for (const plant::Block& block : plant.controls) effects.push_back(block.effect);
    for (const Effect* effect : effects)
      if (!has_float_ops(*effect))
        refuse(fmt::format("{} at {}", effect->name, plant.name),
               "a user-defined model is evaluated in double");
  }
  for (const plant::Consumer& load : grid.loads)
    refuse(fmt::format("{} at {}", load.block.effect->name, load.name),
           "its current is not a linear function of the voltage");
  problems.raise();
}

/// Refuses loads that regulate another bus, because the kernel passes a load the voltage of its own bus only.
void refuse_far_regulation(const grid::Grid& grid) {
  Problems problems;
  for (const plant::Consumer& load : grid.loads)
    if (load.regulated >= 0 && load.regulated != load.bus)
      problems.add(fmt::format("{} at {} regulates bus {}", load.block.effect->name, load.name,
                               grid.network.buses[static_cast<std::size_t>(load.regulated)].number),
                   grid.network.origin, "the batch passes a load model the voltage of its own bus only",
                   "use the reference integrator, or let the load regulate its own bus");
  problems.raise();
}
}  // namespace

struct Batch::Impl {
  BatchOptions options;
  std::unique_ptr<detail::Engine> engine;
};

std::map<int, plant::Plant> changed_plants(const grid::Grid& grid, const Job& job) {
  std::map<int, plant::Plant> changed;
  const auto plant = [&](int index) -> plant::Plant& {
    const grid::Grid& at = job.grid ? *job.grid : grid;
    return changed.try_emplace(index, at.plants[static_cast<std::size_t>(index)]).first->second;
  };
  for (const auto& [index, block, values] : job.parameters) plant::block_at(plant(index), block).p = values;
  return changed;
}

Batch::Batch(const grid::Grid& grid, BatchOptions options) : impl_(std::make_unique<Impl>()) {
  if (options.lanes == 0) options.lanes = widest();
  impl_->options = options;
  refuse_far_regulation(grid);
  switch (options.lanes) {
    case 1:
      impl_->engine = std::make_unique<detail::EngineOf<double>>(grid, options);
      break;
    case 4:
      impl_->engine = std::make_unique<detail::EngineOf<P4>>(grid, options);
      break;
    case 8:
      impl_->engine = std::make_unique<detail::EngineOf<P8>>(grid, options);
      break;
    case FloatPack::lanes:
      refuse_in_float(grid);
      impl_->engine = std::make_unique<detail::EngineOf<FloatPack>>(grid, options);
      break;
    default:
      throw InputError({fmt::format("unsupported number of lanes: {}", options.lanes), "option lanes",
                        "the kernel is compiled for 1, 4 and 8 lanes in double and 16 in float",
                        "choose one of these, or 0 for the widest in double"});
  }
}
Batch::~Batch() = default;

void Batch::run(const std::function<bool(Job&)>& next,
                const std::function<void(const Job&, const Trajectory&)>& done) {
  impl_->engine->run(next, done);
}

std::string Batch::variant() const {
  const int lanes = impl_->options.lanes;
  return fmt::format("dp54 lanes={}{} isa={} tol={:g} angles=moved", lanes,
                     lanes == FloatPack::lanes ? " float" : "", instruction_set(), impl_->options.tolerance);
}

}  // namespace swingbank::sim::batch
