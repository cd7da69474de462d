#include "train/direct/direct.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "base/in_parallel.hpp"
#include "sim/core/frequency.hpp"
#include "sim/direct/refine.hpp"
#include "sim/library/library.hpp"

namespace swingbank::train::direct {
namespace {

namespace store = mpi::store;
constexpr std::size_t kRowsRead = 512;  ///< rows read at once

/// What a row of the dataset is made of.
class Rows {
 public:
  explicit Rows(const store::Dataset& d) : dataset_(d) {
    Problems problems;
    const std::string where = (d.path / "dataset.json").string();
    effect_ = sim::library::compiled().find(d.machine_model);
    if (!effect_ || !effect_->closed_form)
      problems.add("no closed form for " + d.machine_model, where,
                   "nobody has written one for this machine's equations",
                   "leave closed-form and refined out of the preset's networks");
    if (!d.parameter_effects.empty())
      problems.add("parameters of other effects", where, "a closed form knows the machine alone",
                   "leave closed-form and refined out of the preset's networks");
    const bool needs_field = effect_ && effect_->states.size() > 2;
    for (const char* name : {"V", "P", "Q", "speed", "Ifd"})
      if (channel(name) < 0 && (needs_field || name != std::string_view("Ifd")))
        missing(name, problems, where);
    if (channel("theta") < 0 && channel("frequency") < 0) missing("theta or frequency", problems, where);
    problems.raise();
    store::require_machines(d, d.path);
    const auto filter = store::config_numbers(d, "record.frequency");
    if (filter.size() == 2) filter_ = {filter[0], filter[1]};
    conventions_ = store::config_text(d, "convention") == "andes" ? sim::Conventions::andes(d.frequency)
                                                                  : sim::Conventions::psse(d.frequency);
    for (const auto& name : d.held_names)
      if (effect_->parameter_index(name) < 0)
        problems.add("held parameter " + name, where, d.machine_model + " has no such parameter",
                     "use the version of the software that made the dataset");
    problems.raise();
    for (std::size_t g = 0; g < d.generators.size(); ++g) {
      auto& known = known_[d.generators[g]] = effect_->standard_parameters();
      for (std::size_t k = 0; k < d.held_names.size(); ++k)
        known[static_cast<std::size_t>(effect_->parameter_index(d.held_names[k]))] = d.held[g][k];
    }
    for (std::size_t k = 0; k < d.parameter_names.size(); ++k) {
      const int index = effect_->parameter_index(d.parameter_names[k]);
      index_.push_back(index);
      if (d.parameter_low[k] == d.parameter_high[k]) {
        for (auto& [generator, known] : known_) known[static_cast<std::size_t>(index)] = d.parameter_low[k];
      } else {
        free_.push_back(index);
        low_.push_back(d.parameter_low[k]);
        high_.push_back(d.parameter_high[k]);
      }
    }
  }

  /// One row's parameters, inside the box.
  void estimate(const store::RowBlock& block, std::size_t row, bool refined, double* out) const {
    const sim::Recording r = recording(block, row);
    const std::vector<double>& known = known_.at(block.generator[row]);
    auto found = effect_->closed_form(r, known.data());
    if (found.empty()) found.push_back(known);
    if (refined) found = {sim::direct::refine_best(*effect_, r, found, free_, low_, high_).p};
    for (std::size_t k = 0; k < index_.size(); ++k) {
      const double low = dataset_.parameter_low[k], high = dataset_.parameter_high[k];
      const double value = found.front()[static_cast<std::size_t>(index_[k])];
      out[k] = std::isfinite(value) ? std::clamp(value, low, high) : 0.5 * (low + high);
    }
  }

 private:
  [[nodiscard]] int channel(std::string_view name) const {
    const auto at = std::ranges::find(dataset_.channel_names, name);
    return at == dataset_.channel_names.end() ? -1 : static_cast<int>(at - dataset_.channel_names.begin());
  }
  static void missing(const std::string& name, Problems& problems, const std::string& where) {
    problems.add("no channel " + name, where, "the closed form needs it",
                 "record it ([record] channels of the dataset's config)");
  }
  [[nodiscard]] sim::Recording recording(const store::RowBlock& block, std::size_t row) const {
    sim::Recording r;
    r.step = 1 / dataset_.rate;
    r.conventions = conventions_;
    const auto series = [&](std::string_view name, std::vector<double>& out) {
      const int c = channel(name);
      if (c < 0) return;
      const float* first =
          block.records.data() + (row * block.channels + static_cast<std::size_t>(c)) * block.samples;
      out.assign(first, first + block.samples);
    };
    series("V", r.V);
    series("P", r.P);
    series("Q", r.Q);
    series("speed", r.speed);
    series("Ifd", r.Ifd);
    series("theta", r.theta);
    if (r.theta.empty()) {
      std::vector<double> f;
      series("frequency", f);
      r.theta.resize(f.size());
      sim::terminal_angle(f.data(), f.size(), dataset_.rate, conventions_.frequency, filter_, r.theta.data());
    }
    return r;
  }
  const store::Dataset& dataset_;
  const sim::Effect* effect_ = nullptr;
  sim::Conventions conventions_;
  sim::FrequencyFilter filter_;
  std::map<std::int32_t, std::vector<double>> known_;  ///< by generator: held parameters, standard ones else
  std::vector<double> low_, high_;
  std::vector<int> index_, free_;
};

}  // namespace

bool is_method(std::string_view name) { return std::ranges::find(kMethods, name) != kMethods.end(); }

std::vector<double> estimate(const store::Dataset& d, std::span<const std::uint64_t> rows,
                             std::string_view method, const std::function<void(std::size_t)>& tell) {
  const Rows reader(d);
  const std::size_t p = d.parameter_names.size();
  std::vector<double> out(rows.size() * p);
  std::size_t done = 0;
  for (const store::ShardInfo& shard : d.shards) {
    const std::uint64_t end = shard.first_row + shard.rows;
    while (done < rows.size() && rows[done] < end) {
      const std::uint64_t first = rows[done];
      std::size_t last = done;
      while (last < rows.size() && rows[last] < std::min<std::uint64_t>(end, first + kRowsRead)) ++last;
      store::RowBlock block;
      store::read_rows(shard, first - shard.first_row, rows[last - 1] - first + 1, block);
      in_parallel(
          last - done,
          [&](std::size_t k) {
            reader.estimate(block, rows[done + k] - first, method == kMethods[1], &out[(done + k) * p]);
          },
          [](int) {});
      done = last;
      if (tell) tell(done);
    }
  }
  return out;
}

}  // namespace swingbank::train::direct
