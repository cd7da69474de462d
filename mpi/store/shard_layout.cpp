#include "mpi/store/shard_layout.hpp"

namespace swingbank::mpi::store {

namespace {

/// Units, meaning and dimension scales of an array.
struct ArrayDescription {
  const char *name, *units, *long_name;
  std::vector<std::string> scales;  // empty: the array is itself a scale
};

const std::vector<ArrayDescription>& descriptions() {
  static const std::vector<ArrayDescription> all = {
      {"/time", "s", "time since the start of the record", {}},
      {"/channel", "1", "name of the channel", {}},
      {"/parameter", "1", "name of the parameter", {}},
      {"/fault_column", "1", "quantity and unit of a column of fault", {}},
      {"/record_scale_column", "1", "offset or step", {}},
      {"/records",
       "see channel_units",
       "records at the generator's terminal, per unit on its own base",
       {"/sample_id", "/channel", "/time"}},
      {"/record_scale",
       "see channel_units",
       "offset and step of the 16-bit records: value = offset + step * code",
       {"/sample_id", "/channel", "/record_scale_column"}},
      {"/parameters",
       "see parameter_units",
       "parameter values of the generator",
       {"/sample_id", "/parameter"}},
      {"/sample_id", "1", "number of the draw", {}},
      {"/generator", "1", "bus number of the generator", {"/sample_id"}},
      {"/fault", "see fault_column", "fault of the draw", {"/sample_id", "/fault_column"}},
      {"/largest_spread",
       "rad",
       "largest change of the angle between two rotors of an island since the start",
       {"/sample_id"}},
      {"/angle_valid", "1", "0 where V = 0 and theta keeps its last value", {"/sample_id", "/time"}},
      {"/machine_base", "MVA", "base of the generator", {"/sample_id"}},
      {"/draws/sample_id", "1", "number of the draw", {}},
      {"/draws/outcome", "1", "outcome of the draw, see meaning", {"/draws/sample_id"}},
      {"/draws/redrawn_column", "1", "reason of the redraw", {}},
      {"/draws/redrawn",
       "1",
       "number of redraws of the operating point",
       {"/draws/sample_id", "/draws/redrawn_column"}},
  };
  return all;
}

const std::vector<std::string> kFaultLabels = {"bus number", "t_on [s]", "t_off [s]", "r [pu]", "x [pu]"};
const std::vector<std::string> kScaleLabels = {"offset", "step"};
const std::vector<std::string> kRedrawnLabels = {"no power flow", "implausible"};

}  // namespace

void lay_out_axes(h5::File& f, const ShardAxes& a) {
  f.create<double>("/time", {a.samples});
  f.create_labels("/channel", a.channel_names);
  f.create_labels("/parameter", a.parameter_names);
  f.create_labels("/fault_column", kFaultLabels);
  if (f.has("/record_scale")) f.create_labels("/record_scale_column", kScaleLabels);
  if (f.has("/draws/redrawn")) f.create_labels("/draws/redrawn_column", kRedrawnLabels);
  std::vector<h5::File::Axes> axes;
  const bool int16 = f.has("/record_scale");
  for (const ArrayDescription& array : descriptions()) {
    if (!f.has(array.name)) continue;
    if (int16 && array.name == std::string("/records")) {
      f.describe(array.name, "1",
                 "16-bit codes of the records: value = offset + step * code, see record_scale");
    } else {
      f.describe(array.name, array.units, array.long_name);
    }
    if (!array.scales.empty()) axes.push_back({array.name, array.scales});
  }
  f.attach_scales(axes);
}

void fill_axes(h5::File& f, const ShardAxes& a) {
  std::vector<double> time(a.samples);
  for (std::size_t k = 0; k < time.size(); ++k) time[k] = static_cast<double>(k) / a.rate;
  f.write("/time", 0, time.size(), time.data());
  f.write_labels("/channel", a.channel_names);
  f.write_labels("/parameter", a.parameter_names);
  f.write_labels("/fault_column", kFaultLabels);
  if (f.has("/record_scale")) f.write_labels("/record_scale_column", kScaleLabels);
  if (f.has("/draws/redrawn")) f.write_labels("/draws/redrawn_column", kRedrawnLabels);
}

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
  } else {
    f.create<float>("/records", {n.rows, a.channel_names.size(), d.samples});
  }
  f.create<double>("/parameters", {n.rows, a.parameter_names.size()});
  f.create<std::uint64_t>("/sample_id", {n.rows});
  f.create<std::int32_t>("/generator", {n.rows});
  f.create<double>("/fault", {n.rows, kFaultColumns});
  f.create<double>("/largest_spread", {n.rows});
  for (const auto& c : a.channel_names)
    if (c == "theta" || c == "frequency") {
      f.create<std::uint8_t>("/angle_valid", {n.rows, d.samples});
      break;
    }
  if (a.operating_points) f.create<double>("/machine_base", {n.rows});
  f.create_group("/draws");
  f.create<std::uint64_t>("/draws/sample_id", {n.draws});
  f.create<std::uint8_t>("/draws/outcome", {n.draws});
  std::vector<std::string> meaning;
  for (std::uint8_t i = 0; i <= kRefused; ++i) meaning.emplace_back(draw_outcome_name(i));
  f.attribute("meaning", meaning, "/draws/outcome");
  if (a.operating_points) f.create<std::int32_t>("/draws/redrawn", {n.draws, kRedrawnColumns});
  lay_out_axes(f, {a.channel_names, a.parameter_names, d.samples, a.rate});
}

void fill_shard(h5::File& f, const ShardData& d, std::uint64_t first_row, std::uint64_t first_draw) {
  if (const ShardAttributes& a = d.attributes; first_draw == 0)
    fill_axes(f, {a.channel_names, a.parameter_names, d.samples, a.rate});
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
