// Conversion of one plant of a simulated run to a record.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/sha256.hpp"
#include "mpi/store/hdf5_file.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

/// Returns the requested plant, or the only one.
std::size_t choose_plant(const std::vector<std::string>& plants, const std::string& asked,
                         const std::string& file) {
  std::string all;
  for (const auto& p : plants) all += (all.empty() ? "" : ", ") + p;
  if (asked.empty() && plants.size() == 1) return 0;
  const auto found = std::ranges::find(plants, asked);
  if (found == plants.end())
    throw InputError({asked.empty() ? "several plants" : "no plant '" + asked + "'", file,
                      "the run has " + all,
                      "choose one: FILE#" + (plants.empty() ? "PLANT" : plants.front())});
  return static_cast<std::size_t>(found - plants.begin());
}

}  // namespace

Record read_hdf5_record(const std::filesystem::path& file, const RecordBase& base,
                        const ReadOptions& options) {
  const std::string bytes = read_bytes(file);
  const mpi::store::h5::File h = mpi::store::h5::File::open_apart(
      file, {"f8/time", "f8/records", "text@format", "text@plant_names", "text@channel_names",
             "text@channel_units", "real@plant_base_mva"});
  if (!h.has("/time") || !h.has("/records") || !h.has_attribute("format") ||
      h.text_attribute("format") != "swingbank-run-1")
    throw InputError({"no run", file.string(), "HDF5 records are runs written by swingbank simulate",
                      "give such a file, CSV or COMTRADE"});
  const auto plants = h.texts_attribute("plant_names"), channels = h.texts_attribute("channel_names");
  const auto mva = h.reals_attribute("plant_base_mva");
  std::vector<double> time, values;
  h.read("/time", time);
  h.read("/records", values);
  const mpi::store::h5::Shape shape = h.shape("/records");
  if (shape.size() != 3 || shape[0] != plants.size() || shape[1] != channels.size() ||
      shape[2] != time.size() || mva.size() != plants.size() || plants.empty())
    throw InputError({"a run whose parts do not fit", file.string(),
                      "/records must be plants x channels x samples", "simulate it again"});
  const std::size_t plant = choose_plant(plants, options.terminal, file.string());
  const std::size_t n = time.size();
  RawRecord raw;
  raw.about.name = file.filename().string();
  raw.about.format = "HDF5";
  raw.about.terminal = plants[plant];
  raw.about.sha256 = sha256(bytes);
  std::vector<Heading> headings{{"t_s", ColumnMeaning{Quantity::time, Unit::second, false, {}, false}}};
  const auto units = h.texts_attribute("channel_units");
  for (std::size_t c = 0; c < channels.size(); ++c)
    headings.push_back({channels[c], column_meaning(channels[c], c < units.size() ? units[c] : "")});
  Problems problems;
  const auto chosen = choose_columns(headings,
                                     {.columns = options.columns,
                                      .part = options.part,
                                      .component = options.component,
                                      .needed = options.needed},
                                     base, file.string(), raw.about, problems);
  raw.about.terminal = plants[plant];
  problems.raise();
  for (const auto i : chosen) {
    const ColumnMeaning& m = *headings[i].meaning;
    std::vector<double> column = time;
    if (i > 0) {
      const auto from = values.begin() + static_cast<std::ptrdiff_t>((plant * channels.size() + i - 1) * n);
      column.assign(from, from + static_cast<std::ptrdiff_t>(n));
    }
    if (m.quantity == Quantity::P || m.quantity == Quantity::Q || m.quantity == Quantity::Pm)
      for (double& x : column) x *= mva[plant] / base.mva;
    raw.columns.push_back({headings[i].name, m, std::move(column)});
  }
  SampleFaults faults([&](std::size_t first, std::size_t last) {
    return fmt::format("{}:/records, samples {}-{}", file.string(), first, last);
  });
  for (const auto& c : raw.columns)
    for (std::size_t k = 0; k < n; ++k)
      if (!std::isfinite(c.values[k]))
        faults.add(c.name, c.name, k, "the value is not finite", "simulate it again");
  return build_record(std::move(raw), base, options, std::move(faults), std::move(problems), file.string());
}

}  // namespace swingbank::validate::record
