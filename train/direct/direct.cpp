#include "train/direct/direct.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/in_parallel.hpp"
#include "base/stop_signal.hpp"
#include "sim/core/frequency.hpp"
#include "sim/direct/likelihood.hpp"
#include "sim/direct/refine.hpp"
#include "sim/direct/smooth.hpp"
#include "sim/library/library.hpp"

namespace swingbank::train::direct {
namespace {

namespace store = mpi::store;
constexpr double kWeights = 1e-4;       ///< noise level for channel weights if the records have no noise
constexpr double kNoPrior = 1e3;        ///< standard deviation of a prior without influence [box widths]
constexpr std::size_t kRowsRead = 512;  ///< rows read at once
enum class Method { closed_form, refined, curve_fit, floor, from_start };  ///< in order of kMethods

/// Reads rows of the dataset and estimates their parameters.
class Rows {
 public:
  Rows(const store::Dataset& d, Method method, const data::NoiseRecipe& noise)
      : dataset_(d), method_(method), noise_(d, noise), level_{noise.level} {
    Problems problems;
    const std::string where = (d.path / "dataset.json").string();
    effect_ = sim::library::compiled().find(d.machine_model);
    const bool starts = method == Method::closed_form || method == Method::refined;
    if (!effect_ || (!effect_->closed_form && starts))
      problems.add("no closed form for " + d.machine_model, where,
                   "the closed-form estimator does not support this machine model",
                   "leave closed-form, refined and corrects out of the preset");
    const bool likely = method != Method::closed_form;
    if (effect_ && likely && !sim::direct::has_likelihood(*effect_))
      problems.add("no likelihood for " + d.machine_model, where,
                   "it has too many states, or no constant impedance behind its terminal",
                   "leave refined, curve-fit, floor and steps_from out of the preset");
    if (!d.parameter_effects.empty())
      problems.add("parameters of other effects", where,
                   "methods without training estimate machine parameters only",
                   "leave closed-form, refined, curve-fit, floor, corrects and steps_from out of the preset");
    fluxes_ = effect_ && effect_->states.size() > 2;
    for (const char* name : {"V", "P", "Q", "speed", "Ifd"})
      if (channel(name) < 0 && (fluxes_ || name != std::string_view("Ifd"))) missing(name, problems, where);
    if (channel("theta") < 0 && channel("frequency") < 0) missing("theta or frequency", problems, where);
    problems.raise();
    store::require_machines(d, d.path);
    filter_ = data::frequency_filter(d);
    const auto start = store::config_numbers(d, "fault.start");
    if (start.size() == 1) event_ = start[0];
    conventions_ = store::config_text(d, "convention") == "andes" ? sim::Conventions::andes(d.frequency)
                                                                  : sim::Conventions::psse(d.frequency);
    for (const auto& name : d.held_names)
      if (effect_->parameter_index(name) < 0)
        problems.add("unknown fixed parameter " + name, where, d.machine_model + " has no such parameter",
                     "use the version of Swingbank that generated the dataset");
    problems.raise();
    for (std::size_t g = 0; g < d.generators.size(); ++g) {
      auto& known = known_[d.generators[g]] = effect_->default_parameters();
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
        unknown_.push_back(sim::direct::uniform_prior(index, low_.back(), high_.back()));
      }
    }
  }

  /// Estimates one row's parameters, clamped to the box. `out`: with from_start, initially the start. For the
  /// floor see direct.hpp.
  void estimate(store::RowBlock& block, std::size_t row, std::uint64_t number, double* out) const {
    if (method_ == Method::floor) return floor(block, row, out);
    if (!noise_.none()) noise_.add(number, block.records.data() + row * block.channels * block.samples);
    std::vector<double> start = known_.at(block.generator[row]);
    if (method_ == Method::from_start)
      for (std::size_t k = 0; k < index_.size(); ++k) start[static_cast<std::size_t>(index_[k])] = out[k];
    const std::vector<double> p = found(recording(block, row), start);
    for (std::size_t k = 0; k < index_.size(); ++k) {
      const double low = dataset_.parameter_low[k], high = dataset_.parameter_high[k];
      const double value = p[static_cast<std::size_t>(index_[k])];
      out[k] = std::isfinite(value) ? std::clamp(value, low, high) : 0.5 * (low + high);
    }
  }

 private:
  [[nodiscard]] std::vector<double> found(const sim::Recording& r, const std::vector<double>& known) const {
    if (method_ == Method::curve_fit) return fitted(r, known);
    if (method_ == Method::from_start) return sim::direct::most_probable_near(*effect_, r, known, unknown_).p;
    auto all = effect_->closed_form(noise_.none() ? r : sim::direct::smoothed(r), known.data());
    if (all.empty()) all.push_back(known);
    if (method_ == Method::closed_form) return all.front();
    if (!noise_.none()) return sim::direct::most_probable_of(*effect_, r, all, unknown_).p;
    all.insert(all.begin(), sim::direct::refine_best(*effect_, r, all, free_, low_, high_).p);
    if (!fluxes_) return all.front();  // the fit of the integrated swing equation is already exact
    return sim::direct::most_probable_of(*effect_, weighted(r), all, anywhere()).p;
  }
  /// Fits with the defaults as the only start.
  [[nodiscard]] std::vector<double> fitted(const sim::Recording& r, const std::vector<double>& known) const {
    return sim::direct::most_probable(*effect_, noise_.none() ? weighted(r) : r, known, anywhere()).p;
  }
  /// Returns a noise-free record with the channel weights of noise level kWeights.
  static sim::Recording weighted(sim::Recording r) {
    r.noise = sim::MeasurementNoise{kWeights};
    return r;
  }
  /// Returns priors so wide that they only bound the parameters to the box.
  [[nodiscard]] std::vector<sim::direct::ParameterPrior> anywhere() const {
    auto all = unknown_;
    for (auto& f : all) f.deviation = kNoPrior * (f.high - f.low);
    return all;
  }
  void floor(const store::RowBlock& block, std::size_t row, double* out) const {
    const sim::Recording r = recording(block, row);
    std::vector<double> truth = known_.at(block.generator[row]);
    const double* labels = block.parameters.data() + row * index_.size();
    for (std::size_t k = 0; k < index_.size(); ++k) truth[static_cast<std::size_t>(index_[k])] = labels[k];
    const auto variance = sim::direct::error_bound(*effect_, r, truth, unknown_);
    std::copy_n(labels, index_.size(), out);
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const auto at = std::ranges::find(index_, free_[k]) - index_.begin();
      out[at] += std::sqrt(variance[k]);
    }
  }
  [[nodiscard]] int channel(std::string_view name) const {
    const auto at = std::ranges::find(dataset_.channel_names, name);
    return at == dataset_.channel_names.end() ? -1 : static_cast<int>(at - dataset_.channel_names.begin());
  }
  static void missing(const std::string& name, Problems& problems, const std::string& where) {
    problems.add("no channel " + name, where, "methods without training need it",
                 "record it ([record] channels of the dataset's config)");
  }
  [[nodiscard]] sim::Recording recording(const store::RowBlock& block, std::size_t row) const {
    sim::Recording r;
    r.step = 1 / dataset_.rate;
    r.conventions = conventions_;
    r.noise = level_;
    r.event = event_;
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
  bool fluxes_ = false;  ///< whether the machine has states other than angle and speed
  sim::Conventions conventions_;
  sim::FrequencyFilter filter_;
  Method method_;
  data::RecordNoise noise_;
  sim::MeasurementNoise level_;
  /// Fault time [s].
  double event_ = 0;
  /// Parameters by generator: the dataset's value if it is constant, else the default.
  std::map<std::int32_t, std::vector<double>> known_;
  std::vector<double> low_, high_;
  std::vector<int> index_, free_;
  std::vector<sim::direct::ParameterPrior> unknown_;
};

/// Estimates the rows in parallel, and writes the estimates to `out`.
void for_each_row(const store::Dataset& d, std::span<const std::uint64_t> rows, const Rows& reader,
                  std::vector<double>& out, const std::function<void(std::size_t)>& report) {
  const std::size_t p = d.parameter_names.size();
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
            const std::uint64_t row = rows[done + k];
            reader.estimate(block, row - first, row, &out[(done + k) * p]);
          },
          [](int) {});
      done = last;
      if (report) report(done);
      if (stop_asked()) throw Interrupted{};
    }
  }
}

}  // namespace

bool is_method(std::string_view name) { return std::ranges::find(kMethods, name) != kMethods.end(); }

std::vector<double> estimate(const store::Dataset& d, std::span<const std::uint64_t> rows,
                             std::string_view method, const data::NoiseRecipe& noise,
                             const std::function<void(std::size_t)>& report) {
  const auto which = static_cast<Method>(std::ranges::find(kMethods, method) - kMethods.begin());
  if (which == Method::floor && noise.level == 0)
    throw InputError({"method floor without noise", "--network floor",
                      "without noise there is no Cramér-Rao bound",
                      "give --noise, or choose another method"});
  std::vector<double> out(rows.size() * d.parameter_names.size());
  for_each_row(d, rows, Rows(d, which, noise), out, report);
  return out;
}

std::vector<double> estimate_from(const store::Dataset& d, std::span<const std::uint64_t> rows,
                                  std::span<const double> starts, const data::NoiseRecipe& noise,
                                  const std::function<void(std::size_t)>& report) {
  if (noise.level == 0)
    throw InputError({"a likelihood search without noise", "--noise",
                      "the likelihood of a record needs its noise level", "give --noise above 0"});
  std::vector<double> out(starts.begin(), starts.end());
  for_each_row(d, rows, Rows(d, Method::from_start, noise), out, report);
  return out;
}

}  // namespace swingbank::train::direct
