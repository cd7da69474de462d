#include "train/run/saved_network.hpp"

#include <ATen/ATen.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/input_file.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/sealed_file.hpp"
#include "train/run/detail/posterior.hpp"
#include "train/run/detail/result.hpp"

namespace swingbank::train::run {
namespace {
using nlohmann::json;
namespace fs = std::filesystem;
constexpr SealedKind kNetwork{"network file", "swingbank-network-1\n", "train it again"};

double rms(const float* values, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(values[i]) * values[i];
  return std::sqrt(sum / static_cast<double>(count));
}

/// Returns the largest root mean square of the rows' normalised inputs.
double largest_input(const data::ShardStream& stream, const data::Features& features,
                     std::span<const std::uint64_t> rows) {
  const std::size_t size = features.channels() * features.length();
  std::vector<float> x;
  double largest = 0.0;
  data::BatchReader reader(stream, {rows.begin(), rows.end()}, 512, 0, stream.validation());
  for (data::Batch batch; reader.next(batch);) {
    x.resize(batch.rows.size() * size);
    features.apply(batch.series.data(), batch.rows.size(), x.data());
    for (std::size_t r = 0; r < batch.rows.size(); ++r)
      largest = std::max(largest, rms(x.data() + r * size, size));
  }
  return largest;
}

/// Returns the parameters with bias and RMS error on the test rows, which are not used in training. In a
/// fold, these are the rows of the generator left out.
json judged_parameters(const PreparedRun& run, const Trained& trained) {
  const mpi::store::Dataset& d = run.stream.dataset();
  const data::Labels& labels = run.stream.labels();
  const std::size_t p = labels.parameters;
  const std::vector<float> out = loop::predict(*trained.network, run.stream, trained.features, run.split.test,
                                               {}, run.stream.validation());
  std::vector<double> sum(p), square(p);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double estimate =
        std::clamp(run.scale.raw(out[i], i % p), d.parameter_low[i % p], d.parameter_high[i % p]);
    const double error = estimate - labels.values[run.split.test[i / p] * p + i % p];
    sum[i % p] += error;
    square[i % p] += error * error;
  }
  const auto rows = static_cast<double>(run.split.test.size());
  json list = json::array();
  for (std::size_t i = 0; i < p; ++i)
    list.push_back({{"name", d.parameter_names[i]},
                    {"unit", d.parameter_units[i]},
                    {"effect", d.parameter_effects.empty() ? d.machine_model : d.parameter_effects[i]},
                    {"low", d.parameter_low[i]},
                    {"high", d.parameter_high[i]},
                    {"bias", sum[i] / rows},
                    {"spread", std::sqrt(square[i] / rows)},
                    {"mean", run.scale.mean[i]},
                    {"scale", run.scale.unit[i]},
                    {"origin", run.scale.origin[i]}});
  return list;
}

json physics_json(const data::InputSelection& s) {
  if (!s.physics) return {};
  const data::PhysicsWindow& w = s.physics->window();
  return {{"start_s", w.start_s},
          {"end_s", w.end_s},
          {"event_s", w.event_s},
          {"reactance", w.reactance},
          {"least_voltage", w.least_voltage}};
}

json swing_json(const data::InputSelection& s) {
  if (!s.swing) return {};
  const data::SwingWindow& w = s.swing->window();
  return {{"start_s", w.start_s},
          {"end_s", w.end_s},
          {"event_s", w.event_s},
          {"system_frequency_Hz", w.system_frequency}};
}

json header_of(const PreparedRun& run, const Trained& trained) {
  const mpi::store::Dataset& d = run.stream.dataset();
  const RunRequest& r = run.request;
  const data::InputSelection& s = run.stream.selection();
  const data::FeatureSizes sizes = trained.features.sizes();
  const auto start = mpi::store::config_numbers(d, "fault.start"),
             filter = mpi::store::config_numbers(d, "record.frequency");
  return {{"run", run.training_identity},
          {"name", run_name(r)},
          {"network", r.network},
          {"kind", run.recipe.kind},
          {"machine_model", d.machine_model},
          {"dataset", {{"name", dataset_name(d)}, {"hash", d.hash}, {"config_hash", d.config_hash}}},
          {"software", d.software},
          {"generator", r.generator ? json(*r.generator) : json()},
          {"channels", r.experiment.input(r.preset, r.network).recipe.channels},
          {"rate_per_s", d.rate},
          {"fault_start_s", start.size() == 1 ? json(start[0]) : json()},
          {"frequency_filter", filter.size() == 2 ? json(filter) : json()},
          {"input",
           {{"first", s.first},
            {"step", s.step},
            {"samples", s.samples},
            {"form", data::kInputForms.at(static_cast<std::size_t>(s.form))}}},
          {"features",
           {{"channels", sizes.channels},
            {"samples", sizes.samples},
            {"pca_components", sizes.pca_components},
            {"pca_per_second", sizes.pca_per_second},
            {"levels", sizes.levels},
            {"kept", sizes.kept},
            {"noisy", sizes.noisy},
            {"seconds_as_steps", sizes.seconds_as_steps},
            {"regressed", sizes.regressed}}},
          {"training",
           {{"epochs", trained.report.epochs},
            {"best_epoch", trained.report.best_epoch},
            {"seconds", trained.report.seconds},
            {"processor_seconds", trained.report.processor_seconds},
            {"validation_mse", trained.report.validation},
            {"curve", loop::learning_curve_json(trained.report.curve)}}},
          {"physics", physics_json(s)},
          {"swing", swing_json(s)},
          {"posterior", trained.posterior.head ? maps_json(trained.posterior) : json()},
          {"input_rms_seen", largest_input(run.stream, trained.features, run.split.validation)},
          {"parameters", judged_parameters(run, trained)}};
}

data::InputForm form_of(const std::string& name) {
  const auto found = std::ranges::find(data::kInputForms, name);
  if (found == data::kInputForms.end()) throw Unusable{"its input has the unknown form " + name};
  return static_cast<data::InputForm>(found - data::kInputForms.begin());
}

NetworkInfo info_of(const json& h) {
  NetworkInfo i;
  h.at("name").get_to(i.run);
  h.at("network").get_to(i.network);
  h.at("kind").get_to(i.kind);
  h.at("machine_model").get_to(i.machine_model);
  h.at("dataset").at("name").get_to(i.dataset);
  h.at("dataset").at("hash").get_to(i.dataset_hash);
  h.at("software").get_to(i.software);
  h.at("channels").get_to(i.channels);
  h.at("rate_per_s").get_to(i.rate);
  h.at("input_rms_seen").get_to(i.input_rms_seen);
  if (!h.at("generator").is_null()) i.left_out = h["generator"].get<std::int32_t>();
  if (!h.at("fault_start_s").is_null()) i.fault_start = h["fault_start_s"].get<double>();
  if (!h.at("frequency_filter").is_null()) {
    i.frequency.emplace();
    i.frequency->washout = h["frequency_filter"].at(0);
    i.frequency->filter = h["frequency_filter"].at(1);
  }
  for (const auto& p : h.at("parameters"))
    i.parameters.push_back({p.at("name"), p.at("unit"), p.at("effect"), p.at("low"), p.at("high"),
                            p.at("bias"), p.at("spread")});
  return i;
}

/// Returns the network's shape. The initial bias is a placeholder, because the weights are read afterwards.
networks::NetworkShape shape_of(const data::FeatureSizes& s, std::vector<networks::Target> targets) {
  const std::size_t outputs = targets.size();
  if (s.kept > 0)
    return {1, static_cast<std::int64_t>(s.kept + s.levels + 1 + s.noisy + s.regressed),
            static_cast<std::int64_t>(outputs), std::vector<float>(outputs, 0.0f), std::move(targets)};
  const std::size_t seconds = s.pca_per_second > 0 ? s.samples / s.pca_per_second : 0;
  const std::size_t length = s.pca_components > 0 ? seconds * s.pca_components : s.samples;
  const std::size_t steps = s.seconds_as_steps > 0 ? seconds : length;
  return {static_cast<std::int64_t>(s.channels * length / steps), static_cast<std::int64_t>(steps),
          static_cast<std::int64_t>(outputs), std::vector<float>(outputs, 0.0f), std::move(targets)};
}

std::vector<networks::Target> targets_of(const NetworkInfo& info, const data::TargetScale& scale) {
  std::vector<networks::Target> all;
  for (std::size_t i = 0; i < info.parameters.size(); ++i)
    all.push_back({info.parameters[i].name, scale.mean[i], scale.unit[i], scale.origin[i]});
  return all;
}

/// Returns the file itself, or the only network file of a folder.
fs::path find_file(const fs::path& path) {
  if (!fs::is_directory(path)) {
    if (fs::exists(path)) return path;
    throw InputError(unreadable(path, "cannot read the network file",
                                "give a .network file that train or cross-validate wrote beside its result"));
  }
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(path))
    if (entry.path().extension() == ".network") found.push_back(entry.path());
  if (found.size() == 1) return found[0];
  std::ranges::sort(found);
  throw InputError({found.empty() ? "no network file" : fmt::format("{} network files", found.size()),
                    path.string(),
                    found.empty() ? "the folder contains no .network file" : "an estimate uses one network",
                    found.empty() ? "give a folder of results of train or cross-validate"
                                  : fmt::format("name one, for example {}", found[0].string())});
}

}  // namespace

fs::path network_file(const fs::path& result) { return fs::path(result).replace_extension(".network"); }

void save_network(const fs::path& file, const PreparedRun& run, const Trained& trained) {
  const json header = header_of(run, trained);
  const auto features = trained.features.arrays();
  std::vector<std::span<const float>> arrays(features.begin(), features.end());
  std::vector<at::Tensor> weights;
  const auto append = [&](networks::Network& of) {
    for (const auto& w : of.parameters()) {
      weights.push_back(w.detach().contiguous());
      arrays.emplace_back(weights.back().data_ptr<float>(), static_cast<std::size_t>(weights.back().numel()));
    }
  };
  append(*trained.network);
  if (trained.posterior.head) append(*trained.posterior.head);
  write_sealed(kNetwork, file, header, arrays);
}

SavedNetwork::SavedNetwork() : trained_(std::make_unique<Trained>()) {}
SavedNetwork::SavedNetwork(SavedNetwork&&) noexcept = default;
SavedNetwork& SavedNetwork::operator=(SavedNetwork&&) noexcept = default;
SavedNetwork::~SavedNetwork() = default;

SavedNetwork SavedNetwork::load(const fs::path& path) {
  SavedNetwork n;
  n.file_ = find_file(path);
  data::FeatureSizes sizes;
  std::vector<std::vector<float>> features;
  std::vector<at::Tensor> weights;
  const auto start = [&](const json& header, std::size_t arrays) {
    try {
      sizes = n.read_header(header);
    } catch (const json::exception& e) {
      throw Unusable{std::string("its header has another format: ") + e.what()};
    }
    n.trained_->network =
        networks::make_network(n.info_.kind, shape_of(sizes, targets_of(n.info_, n.scale_)));
    for (const auto& w : n.trained_->network->parameters()) weights.push_back(w.detach());
    if (!header.at("posterior").is_null()) {
      n.trained_->posterior.levels = maps_of(header.at("posterior"));
      n.add_head(sizes);
      for (const auto& w : n.trained_->posterior.head->parameters()) weights.push_back(w.detach());
    }
    features.resize(data::Features::array_count(sizes));
    if (arrays != features.size() + weights.size()) throw Unusable{"its number of arrays differs"};
  };
  const auto place = [&](std::size_t i, std::size_t size) -> std::span<float> {
    if (i < features.size()) {
      features[i].resize(size);
      return features[i];
    }
    at::Tensor& w = weights[i - features.size()];
    if (size != static_cast<std::size_t>(w.numel())) throw Unusable{"the length of an array differs"};
    return {w.data_ptr<float>(), size};
  };
  read_sealed(kNetwork, n.file_, start, place);
  try {
    n.trained_->features = data::Features::restore(sizes, features);
  } catch (const Unusable& e) {
    throw InputError({"network file cannot be used", n.file_.string(), e.why, kNetwork.remedy});
  }
  return n;
}

std::unique_ptr<Trained> SavedNetwork::release() { return std::move(trained_); }

void SavedNetwork::add_head(const data::FeatureSizes& sizes) {
  mpi::store::Dataset box;
  for (const auto& p : info_.parameters) {
    box.parameter_low.push_back(p.low);
    box.parameter_high.push_back(p.high);
  }
  const networks::NetworkShape shape = shape_of(sizes, targets_of(info_, scale_));
  trained_->posterior.head =
      make_head(*trained_->network, box, scale_, static_cast<std::size_t>(shape.channels * shape.samples));
}

data::FeatureSizes SavedNetwork::read_header(const json& h) {
  info_ = info_of(h);
  identity_ = std::make_unique<json>(h.at("run"));
  const json& training = h.at("training");
  trained_->report.finished = true;
  training.at("epochs").get_to(trained_->report.epochs);
  training.at("best_epoch").get_to(trained_->report.best_epoch);
  training.at("seconds").get_to(trained_->report.seconds);
  training.at("validation_mse").get_to(trained_->report.validation);
  // Networks of earlier versions have neither processor time nor curve.
  trained_->report.processor_seconds = training.value("processor_seconds", 0.0);
  if (training.contains("curve")) trained_->report.curve = loop::read_learning_curve(training["curve"]);
  for (const auto& p : h.at("parameters")) {
    scale_.mean.push_back(p.at("mean"));
    scale_.unit.push_back(p.at("scale"));
    scale_.origin.push_back(p.at("origin"));
  }
  const json &s = h.at("input"), &f = h.at("features");
  for (std::size_t c = 0; c < info_.channels.size(); ++c) selection_.channels.push_back(c);
  selection_.first = s.at("first");
  selection_.step = s.at("step");
  selection_.samples = s.at("samples");
  selection_.form = form_of(s.at("form"));
  selection_.rate = info_.rate / static_cast<double>(selection_.step);
  info_.samples = selection_.first + (selection_.samples - 1) * selection_.step + 1;
  if (const json& w = h.at("physics"); !w.is_null()) {
    selection_.physics.emplace(
        info_.channels, data::PhysicsWindow{info_.rate, w.at("start_s"), w.at("end_s"), w.at("event_s"),
                                            w.at("reactance"), w.at("least_voltage")});
    info_.samples = selection_.physics->samples();
  }
  if (const json w = h.value("swing", json()); !w.is_null()) {
    selection_.swing.emplace(
        info_.channels,
        data::SwingWindow{info_.rate, w.at("event_s"), w.at("start_s"), w.at("end_s"),
                          w.at("system_frequency_Hz"), info_.frequency.value_or(sim::FrequencyFilter{})});
    info_.samples = selection_.swing->samples();
    info_.needs_reactance = true;
  }
  const data::FeatureSizes sizes = {f.at("channels"),       f.at("samples"),          f.at("pca_components"),
                                    f.at("pca_per_second"), f.at("levels"),           f.at("kept"),
                                    f.at("noisy"),          f.at("seconds_as_steps"), f.at("regressed")};
  selection_.shows_level = info_.noise_as_input = sizes.noisy > 0 || selection_.swing;
  selection_.regressions = sizes.regressed > 0;
  if (selection_.swing ? sizes.samples != selection_.values()
                       : sizes.channels != selection_.outputs() || sizes.samples != selection_.samples)
    throw Unusable{"its sizes are inconsistent"};
  return sizes;
}

Estimate SavedNetwork::estimate(std::span<const float> record, double noise, double reactance) const {
  std::vector<float> series(selection_.values());
  selection_.apply(record.data(), info_.samples, noise, reactance, series.data());
  at::NoGradGuard no_gradients;
  at::Tensor x = at::empty({1, static_cast<std::int64_t>(trained_->features.channels()),
                            static_cast<std::int64_t>(trained_->features.length())},
                           at::kFloat);
  trained_->features.apply(series.data(), 1, x.data_ptr<float>());
  Estimate e;
  e.input_rms = rms(x.data_ptr<float>(), static_cast<std::size_t>(x.numel()));
  const at::Tensor y = trained_->network->forward(x, nullptr).contiguous();
  for (std::size_t i = 0; i < info_.parameters.size(); ++i)
    e.values.push_back(
        std::clamp(scale_.raw(y.data_ptr<float>()[i], i), info_.parameters[i].low, info_.parameters[i].high));
  add_intervals(x, noise, e);
  return e;
}

void SavedNetwork::add_intervals(const at::Tensor& x, double noise, Estimate& e) const {
  e.intervals.resize(info_.parameters.size());
  if (!trained_->posterior.head) return;
  posterior::Head& head = *trained_->posterior.head;
  const at::Tensor numbers = head.forward(x, nullptr).contiguous();
  const auto posteriors =
      head.posteriors({numbers.data_ptr<float>(), static_cast<std::size_t>(numbers.numel())});
  const auto maps = maps_at(trained_->posterior.levels, noise);
  for (std::size_t i = 0; i < head.of().size(); ++i) {
    const posterior::HeadParameter& p = head.of()[i];
    const auto at = [&](double below) {
      return p.low + (p.high - p.low) * posterior::quantile(posteriors.of(0, i), maps[i], below);
    };
    e.intervals[p.output] = Interval{at(0.05), at(0.5), at(0.95)};
  }
}

}  // namespace swingbank::train::run
