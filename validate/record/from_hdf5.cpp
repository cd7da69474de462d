// Conversion of one plant's channels in a simulated run to a record.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/read_apart.hpp"
#include "base/sha256.hpp"
#include "mpi/store/hdf5_apart.hpp"
#include "validate/record/detail/build.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

/// Arrays and attributes of a run, read in a separate process. The calling process then needs no HDF5
/// library, of which a Python process may have loaded another version.
class RunContents {
 public:
  using Array = mpi::store::h5::Contents::Array;
  using Texts = std::vector<std::string>;
  using Reals = std::vector<double>;

  explicit RunContents(const std::filesystem::path& file)
      : file_(file),
        contents_(mpi::store::h5::Contents::parse(
            read_apart("hdf5", file,
                       {"f8/time", "f8/records", "text@format", "text@plant_names", "text@channel_names",
                        "text@channel_units", "real@plant_base_mva"}),
            file)) {
    if (get<Texts>("@format") != Texts{"swingbank-run-1"}) refuse();
  }
  /// Returns an attribute, or an array with its shape.
  template <class T>
  [[nodiscard]] const T& get(const std::string& name) const {
    const auto* value = contents_.find(name);
    const T* found = value == nullptr ? nullptr : std::get_if<T>(value);
    if (found == nullptr) refuse();
    return *found;
  }
  /// Returns the values of an array.
  [[nodiscard]] std::vector<double> values(const std::string& name) const {
    const Array& a = get<Array>(name);
    if (a.kind != "f8") refuse();
    std::vector<double> all(a.bytes.size() / sizeof(double));
    if (!all.empty()) std::memcpy(all.data(), a.bytes.data(), all.size() * sizeof(double));
    return all;
  }

 private:
  [[noreturn]] void refuse() const {
    throw InputError({"not a run of swingbank simulate", file_.string(),
                      "HDF5 records are runs written by swingbank simulate",
                      "give such a file, CSV or COMTRADE"});
  }
  std::filesystem::path file_;
  mpi::store::h5::Contents contents_;
};

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
  const RunContents run(file);
  const auto &plants = run.get<RunContents::Texts>("@plant_names"),
             &channels = run.get<RunContents::Texts>("@channel_names");
  const auto& mva = run.get<RunContents::Reals>("@plant_base_mva");
  const std::vector<double> time = run.values("/time"), values = run.values("/records");
  const auto& shape = run.get<RunContents::Array>("/records").shape;
  if (shape.size() != 3 || shape[0] != plants.size() || shape[1] != channels.size() ||
      shape[2] != time.size() || mva.size() != plants.size() || plants.empty())
    throw InputError({"inconsistent sizes of the arrays of a run", file.string(),
                      "/records must be plants x channels x samples", "simulate it again"});
  const std::size_t plant = choose_plant(plants, options.terminal, file.string());
  const std::size_t n = time.size();
  RawRecord raw;
  raw.about.name = file.filename().string();
  raw.about.format = "HDF5";
  raw.about.terminal = plants[plant];
  raw.about.sha256 = sha256(bytes);
  std::vector<Heading> headings{{"t_s", ColumnMeaning{Quantity::time, Unit::second, false, {}, false}}};
  const auto& units = run.get<RunContents::Texts>("@channel_units");
  for (std::size_t c = 0; c < channels.size(); ++c)
    headings.push_back({channels[c], column_meaning(channels[c], c < units.size() ? units[c] : "")});
  Problems problems;
  ReadOptions of_columns = options;
  of_columns.terminal.clear();  // it is the plant chosen above
  const auto chosen = choose_columns(headings, of_columns, base, file.string(), raw.about, problems);
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
        c.meaning.quantity == Quantity::time
            ? faults.add(c.name, c.name, k, "the value is not finite", "simulate it again")
            : faults.lose(c.name, c.name, k, "the value is missing", "simulate it with shorter gaps");
  return build_record(std::move(raw), base, options, std::move(faults), std::move(problems), file.string());
}

}  // namespace swingbank::validate::record
