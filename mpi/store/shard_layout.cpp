#include "mpi/store/shard_layout.hpp"

namespace swingbank::mpi::store {

void lay_out_shard(h5::File& f, const ShardData& d, ShardSize n) {
  const ShardAttributes& a = d.attributes;
  f.attribute("format", std::string(a.int16 ? kInt16Format : kShardFormat));
  f.attribute("config_hash", a.config_hash);
  f.attribute("kernel", a.kernel);
  f.attribute("software", a.software);
  f.attribute("seed", a.seed);
  f.attribute("shard", a.shard);
  f.attribute("rate", a.rate);
  f.attribute("machine_model", a.machine_model);
  f.attribute("channel_names", a.channel_names);
  f.attribute("channel_units", a.channel_units);
  f.attribute("parameter_names", a.parameter_names);
  f.attribute("parameter_units", a.parameter_units);
  f.attribute("parameter_low", a.parameter_low);
  f.attribute("parameter_high", a.parameter_high);
  if (!a.parameter_effects.empty()) f.attribute("parameter_effects", a.parameter_effects);
  if (a.int16) {
    f.create<std::int16_t>("/records", {n.rows, a.channel_names.size(), d.samples});
    f.create<float>("/record_scale", {n.rows, a.channel_names.size(), kScaleColumns});
    f.attribute("columns", std::vector<std::string>{"offset", "step"}, "/record_scale");
  } else {
    f.create<float>("/records", {n.rows, a.channel_names.size(), d.samples});
  }
  f.create<double>("/parameters", {n.rows, a.parameter_names.size()});
  f.create<std::uint64_t>("/sample_id", {n.rows});
  f.create<std::int32_t>("/generator", {n.rows});
  f.create<double>("/fault", {n.rows, kFaultColumns});
  f.attribute("columns", std::vector<std::string>{"bus number", "t_on [s]", "t_off [s]", "r [pu]", "x [pu]"},
              "/fault");
  f.create<double>("/largest_spread", {n.rows});
  f.attribute("unit", std::string("rad"), "/largest_spread");
  for (const auto& c : a.channel_names)
    if (c == "theta" || c == "frequency") {
      f.create<std::uint8_t>("/angle_valid", {n.rows, d.samples});
      break;
    }
  if (a.operating_points) {
    f.create<double>("/machine_base", {n.rows});
    f.attribute("unit", std::string("MVA"), "/machine_base");
  }
  f.create_group("/draws");
  f.create<std::uint64_t>("/draws/sample_id", {n.draws});
  f.create<std::uint8_t>("/draws/outcome", {n.draws});
  std::vector<std::string> meaning;
  for (std::uint8_t i = 0; i <= kRefused; ++i) meaning.emplace_back(draw_outcome_name(i));
  f.attribute("meaning", meaning, "/draws/outcome");
  if (!a.operating_points) return;
  f.create<std::int32_t>("/draws/redrawn", {n.draws, kRedrawnColumns});
  f.attribute("columns", std::vector<std::string>{"no power flow", "implausible"}, "/draws/redrawn");
}

void fill_shard(h5::File& f, const ShardData& d, std::uint64_t first_row, std::uint64_t first_draw) {
  if (d.attributes.int16) {
    f.write("/records", first_row, d.rows, d.codes.data());
    f.write("/record_scale", first_row, d.rows, d.code_scale.data());
  } else {
    f.write("/records", first_row, d.rows, d.records.data());
  }
  f.write("/parameters", first_row, d.rows, d.parameters.data());
  f.write("/sample_id", first_row, d.rows, d.sample_id.data());
  f.write("/generator", first_row, d.rows, d.generator.data());
  f.write("/fault", first_row, d.rows, d.fault.data());
  f.write("/largest_spread", first_row, d.rows, d.largest_spread.data());
  if (f.has("/angle_valid")) f.write("/angle_valid", first_row, d.rows, d.angle_valid.data());
  if (f.has("/machine_base")) f.write("/machine_base", first_row, d.rows, d.machine_base.data());
  f.write("/draws/sample_id", first_draw, d.draw_sample_id.size(), d.draw_sample_id.data());
  f.write("/draws/outcome", first_draw, d.draw_outcome.size(), d.draw_outcome.data());
  if (f.has("/draws/redrawn"))
    f.write("/draws/redrawn", first_draw, d.draw_outcome.size(), d.draw_redrawn.data());
}

}  // namespace swingbank::mpi::store
