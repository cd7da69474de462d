#include "mpi/draw/shard_maker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mpi/store/quantise.hpp"

namespace swingbank::mpi::draw {

namespace {
/// Voltage below which the angle is undefined [pu]. A bolted fault at the terminal gives 1e-12 instead of 0,
/// because the kernel keeps square roots differentiable.
constexpr double kNoVoltage = 1e-6;
}  // namespace

/// Buffers with space for every draw's rows, compacted once the stable draws are known.
struct ShardMaker::Slots {
  std::uint64_t first;
  std::size_t per_draw, channels, samples;
  std::vector<Draw> draws;
  std::vector<std::uint8_t> outcome;
  std::vector<double> angle_spread;
  std::vector<float> records;
  std::vector<std::uint8_t> valid;
};

ShardMaker::ShardMaker(const Study& study, const Databank& bank)
    : study_(study), bank_(bank), sampler_(study, bank) {
  const auto position = [&](sim::Channel c) {
    const auto found = std::ranges::find(simulated_, c);
    if (found != simulated_.end()) return static_cast<int>(found - simulated_.begin());
    simulated_.push_back(c);
    return static_cast<int>(simulated_.size()) - 1;
  };
  for (const auto& name : study.config.record.channels) {
    angle_recorded_ = angle_recorded_ || name == "frequency" || name == "theta";
    source_.push_back(name == "frequency" ? -1 : position(sim::find_channel(name)->channel));
  }
  if (angle_recorded_) {
    voltage_ = position(sim::Channel::V);
    angle_ = position(sim::Channel::theta);
  }
}

/// Returns the SIMD batch of events of a generator. A batch records the same plants in every run; therefore,
/// with Vary::one, each generator needs its own batch.
sim::batch::Batch& ShardMaker::batch_for(std::size_t generator) {
  auto& batch = batches_[generator];
  if (!batch) {
    sim::batch::BatchOptions options = batch_options(study_.config);
    options.channels = simulated_;
    options.plants =
        study_.config.vary == Vary::all ? study_.plants : std::vector<int>{study_.plants[generator]};
    batch = std::make_unique<sim::batch::Batch>(study_.grid, options);
  }
  return *batch;
}

store::ShardData ShardMaker::make(std::uint64_t first, std::uint64_t count,
                                  const std::function<void(std::uint64_t)>& tick) {
  const DatasetConfig& c = study_.config;
  Slots s{first,
          c.vary == Vary::all ? study_.plants.size() : 1,
          c.record.channels.size(),
          c.record.samples(),
          {},
          {},
          {},
          {},
          {}};
  s.outcome.assign(count, store::kRefused);
  s.angle_spread.assign(count, 0.0);
  s.records.assign(count * s.per_draw * s.channels * s.samples, 0.0F);
  if (angle_recorded_) s.valid.assign(count * s.per_draw * s.samples, 1);
  std::map<std::size_t, std::vector<std::uint64_t>> by_generator;
  for (std::uint64_t id = first; id < first + count; ++id) {
    s.draws.push_back(sampler_.draw(id));
    if (sampler_.refusal(s.draws.back()).empty())
      by_generator[c.vary == Vary::all ? 0 : s.draws.back().recorded[0]].push_back(id);
  }
  for (auto& [generator, ids] : by_generator) run(s, std::move(ids), batch_for(generator), tick);
  store::ShardData made = compact(s);
  if (c.record.int16) store::quantise(made);
  return made;
}

void ShardMaker::run(Slots& s, std::vector<std::uint64_t> ids, sim::batch::Batch& batch,
                     const std::function<void(std::uint64_t)>& tick) {
  std::size_t at = 0;
  std::uint64_t finished = 0;
  batch.run(
      [&](sim::batch::Job& job) {
        tick(std::exchange(finished, 0));
        if (at == ids.size()) return false;
        job = s.draws[ids[at++] - s.first].job;
        return true;
      },
      [&](const sim::batch::Job& job, const sim::Trajectory& t) {
        keep(s, job, t);
        ++finished;
      });
  tick(finished);
}

void ShardMaker::keep(Slots& s, const sim::batch::Job& job, const sim::Trajectory& t) const {
  const std::size_t draw = job.id - s.first;
  s.outcome[draw] = static_cast<std::uint8_t>(t.outcome);
  s.angle_spread[draw] = t.largest_spread;
  if (t.outcome != sim::Outcome::stable) return;
  for (std::size_t g = 0; g < s.per_draw; ++g) keep_row(s, draw * s.per_draw + g, t, g);
  const std::size_t size = s.per_draw * s.channels * s.samples;
  const float* values = s.records.data() + draw * size;
  if (!std::all_of(values, values + size, [](float v) { return std::isfinite(v); }))
    s.outcome[draw] = static_cast<std::uint8_t>(sim::Outcome::not_finite);
}

void ShardMaker::keep_row(Slots& s, std::size_t slot, const sim::Trajectory& t, std::size_t plant) const {
  float* row = s.records.data() + slot * s.channels * s.samples;
  const auto recorded = [&](int channel) { return t.at(static_cast<int>(plant), channel); };
  for (std::size_t c = 0; c < s.channels; ++c) {
    if (source_[c] >= 0) {
      std::copy_n(recorded(source_[c]), s.samples, row + c * s.samples);
      continue;
    }
    std::vector<double> f(s.samples);
    sim::terminal_frequency(recorded(angle_), s.samples, t.rate, study_.grid.conventions.frequency,
                            study_.config.record.frequency, f.data());
    std::copy(f.begin(), f.end(), row + c * s.samples);
  }
  if (!angle_recorded_) return;
  const double* v = recorded(voltage_);
  for (std::size_t k = 0; k < s.samples; ++k) s.valid[slot * s.samples + k] = v[k] > kNoVoltage ? 1 : 0;
}

store::ShardData ShardMaker::compact(Slots& s) const {
  const DatasetConfig& c = study_.config;
  store::ShardData d;
  d.channels = s.channels;
  d.samples = s.samples;
  d.parameter_count = c.box.size();
  const std::size_t record = s.channels * s.samples;
  for (std::size_t i = 0; i < s.draws.size(); ++i) {
    const Draw& draw = s.draws[i];
    d.draw_sample_id.push_back(draw.job.id);
    d.draw_outcome.push_back(s.outcome[i]);
    if (c.operating_point)
      for (const std::uint32_t n : {draw.redrawn.no_power_flow, draw.redrawn.implausible})
        d.draw_redrawn.push_back(static_cast<std::int32_t>(n));
    if (s.outcome[i] != 0) continue;
    const sim::network::BusFault& fault = draw.job.event.faults[0];
    for (std::size_t g = 0; g < s.per_draw; ++g) {
      const std::size_t from = i * s.per_draw + g, to = d.rows++;
      if (from != to) {
        std::copy_n(s.records.data() + from * record, record, s.records.data() + to * record);
        if (angle_recorded_)
          std::copy_n(s.valid.data() + from * s.samples, s.samples, s.valid.data() + to * s.samples);
      }
      const double* point = bank_.point(draw.points[g]);
      d.parameters.insert(d.parameters.end(), point, point + c.box.size());
      d.sample_id.push_back(draw.job.id);
      const auto& buses = study_.grid.network.buses;
      const auto plant = static_cast<std::size_t>(study_.plants[draw.recorded[g]]);
      d.generator.push_back(buses[static_cast<std::size_t>(study_.grid.plants[plant].bus)].number);
      d.fault.insert(d.fault.end(), {static_cast<double>(buses[static_cast<std::size_t>(fault.bus)].number),
                                     fault.t_on, fault.t_off, fault.z.real(), fault.z.imag()});
      d.largest_spread.push_back(s.angle_spread[i]);
      if (c.operating_point) d.machine_base.push_back(draw.job.grid->plants[plant].mva);
    }
  }
  s.records.resize(d.rows * record);
  s.valid.resize(angle_recorded_ ? d.rows * s.samples : 0);
  d.records = std::move(s.records);
  d.angle_valid = std::move(s.valid);
  return d;
}

sim::batch::BatchOptions batch_options(const DatasetConfig& config) {
  sim::batch::BatchOptions o;
  o.t_end = config.record.t_end;
  o.rate = config.record.rate;
  o.tolerance = config.tolerance;
  o.lanes = config.lanes;
  return o;
}

std::string kernel_variant(const Study& study) {
  return sim::batch::Batch(study.grid, batch_options(study.config)).variant();
}

store::ShardAttributes shard_attributes(const Study& study, const std::string& hash,
                                        const std::string& kernel) {
  const DatasetConfig& c = study.config;
  store::ShardAttributes a;
  a.config_hash = hash;
  a.kernel = kernel;
  a.software = "swingbank " SWINGBANK_VERSION;
  a.seed = c.seed;
  a.rate = c.record.rate;
  a.machine_model = c.model;
  for (const auto& name : c.record.channels) {
    const auto* record = sim::find_channel(name);
    a.channel_names.push_back(name);
    a.channel_units.emplace_back(record == nullptr ? "pu" : record->unit);
  }
  a.operating_points = c.operating_point.has_value();
  a.int16 = c.record.int16;
  const auto others = c.other_effects();
  for (const auto& b : c.box) {
    a.parameter_names.push_back(c.name_of(b));
    a.parameter_units.emplace_back(c.record_of(b).unit);
    if (!others.empty()) a.parameter_effects.emplace_back(c.effect_of(b).name);
    a.parameter_low.push_back(b.low);
    a.parameter_high.push_back(b.high);
  }
  return a;
}

}  // namespace swingbank::mpi::draw
