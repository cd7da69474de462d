#include "train/loop/loop.hpp"

#include <ATen/ATen.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/stop_signal.hpp"
#include "train/data/random.hpp"
#include "train/loop/adam.hpp"
#include "train/loop/detail/checkpoint.hpp"
#include "train/runtime/product_count.hpp"

namespace swingbank::train::loop {
namespace {
using at::Tensor;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

/// Returns the processor time of all threads of this process [core-s].
double processor_time() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

/// Returns the features of the rows; with guesses these are appended, and a row is then one channel.
Tensor inputs_of(const data::Batch& batch, const data::Features& features, std::span<const float> guesses,
                 std::size_t all_rows) {
  const auto rows = static_cast<std::int64_t>(batch.rows.size());
  Tensor x = at::empty(
      {rows, static_cast<std::int64_t>(features.channels()), static_cast<std::int64_t>(features.length())},
      at::kFloat);
  features.apply(batch.series.data(), batch.rows.size(), x.data_ptr<float>());
  if (guesses.empty()) return x;
  const auto width = static_cast<std::int64_t>(guesses.size() / all_rows);
  Tensor g = at::empty({rows, 1, width}, at::kFloat);
  for (std::int64_t i = 0; i < rows; ++i)
    std::copy_n(guesses.data() + static_cast<std::int64_t>(batch.rows[static_cast<std::size_t>(i)]) * width,
                width, g.data_ptr<float>() + i * width);
  return at::cat({x.reshape({rows, 1, -1}), g}, 2);
}

/// Position of a run, as stored in a checkpoint beside the arrays.
struct Position {
  std::size_t epoch = 0, batch = 0;  ///< next one, from 0
  std::size_t best_epoch = 0, stale = 0;
  double best = std::numeric_limits<double>::infinity();
  double loss_sum = 0.0;  ///< of this epoch so far, weighted by rows
  double rows = 0.0, seconds = 0.0, processor_seconds = 0.0;
};

class Loop {
 public:
  Loop(networks::Network& network, const LoopData& data, const LoopSettings& settings,
       TrainingProgress& progress)
      : network_(network),
        data_(data),
        settings_(settings),
        progress_(progress),
        weights_(network.parameters()),
        adam_(weights_) {
    outputs_ = static_cast<std::int64_t>(data.targets.size() / data.stream.labels().rows);
    for (const auto& w : weights_) best_.push_back(w.detach().clone());
    if (settings.recipe.average > 0.0)
      for (const auto& w : weights_) average_.push_back(w.detach().clone());
    loss_weights_ =
        data.weights.empty()
            ? at::ones({outputs_}, at::kFloat)
            : at::tensor(at::ArrayRef<float>(data.weights.data(), data.weights.size()), at::kFloat);
    batches_ = (data.train.size() + settings.recipe.batch - 1) / settings.recipe.batch;
  }

  LoopReport run() {
    resume();
    bool saved = false;
    while (at_.epoch < settings_.recipe.epochs && at_.stale < settings_.recipe.patience && !saved)
      saved = !epoch();
    const double spent = seconds(), processor = processor_seconds();
    if (!saved) {
      at::NoGradGuard no_gradients;
      for (std::size_t i = 0; i < weights_.size(); ++i) weights_[i].copy_(best_[i]);
    }
    return {!saved, at_.epoch, at_.best_epoch, spent, at_.best, processor, curve_};
  }

 private:
  /// Trains one epoch. Returns false if the run was asked to stop, after saving it.
  bool epoch() {
    data::BatchReader reader(data_.stream, data::epoch_order(data_.train, settings_.seed, at_.epoch),
                             settings_.recipe.batch, at_.batch,
                             data_.stream.training(settings_.first_draw + at_.epoch));
    data::Batch batch;
    const auto begin = Clock::now();
    const double before = at_.rows;
    while (reader.next(batch)) {
      if (settings_.stop ? settings_.stop() : stop_asked()) {
        save();
        return false;
      }
      step(batch);
      if (seconds_since(last_save_) > settings_.checkpoint_every_s) save();
    }
    judge((at_.rows - before) / seconds_since(begin));
    if (settings_.epoch_done) settings_.epoch_done(curve_);
    ++at_.epoch;
    at_.batch = 0;
    at_.loss_sum = at_.rows = 0.0;
    if (seconds_since(last_save_) >= settings_.checkpoint_after_epoch_s) save();
    return true;
  }

  void step(const data::Batch& batch) {
    seed_torch(data::key(settings_.seed, data::Purpose::dropout, at_.epoch, at_.batch));
    std::optional<runtime::ProductCount> count;
    if (settings_.gflops > 0.0 && operations_per_row_ == 0.0) count.emplace();
    const Tensor loss = loss_of(
        network_.forward(inputs_of(batch, data_.features, data_.guesses, data_.stream.labels().rows), true),
        targets_of(batch.rows));
    const double value = loss.item<double>();
    if (!std::isfinite(value))
      throw InputError({"the training loss is not a number",
                        fmt::format("epoch {}, batch {}", at_.epoch + 1, at_.batch + 1),
                        "the weights have diverged", "lower learning_rate in the experiment"});
    loss.backward();
    if (count) operations_per_row_ = count->operations() / static_cast<double>(batch.rows.size());
    const auto done = at_.epoch * batches_ + at_.batch;
    const TrainingRecipe& recipe = settings_.recipe;
    rate_ = learning_rate(recipe, done, recipe.epochs * batches_);
    adam_.step(rate_, recipe.weight_decay, recipe.clip);
    average_in(static_cast<double>(done));
    at_.loss_sum += value * static_cast<double>(batch.rows.size());
    at_.rows += static_cast<double>(batch.rows.size());
    ++at_.batch;
    progress_.update(at_.epoch * data_.train.size() + static_cast<std::uint64_t>(at_.rows),
                     fmt::format("epoch {} of {}, loss {:.4f}", at_.epoch + 1, settings_.recipe.epochs,
                                 at_.loss_sum / at_.rows));
  }

  [[nodiscard]] Tensor loss_of(const Tensor& out, const Tensor& targets) const {
    if (data_.loss) return data_.loss(out, targets);
    if (const Tensor own = network_.loss(out, targets); own.defined()) return own;
    return ((out - targets).square() * loss_weights_).mean();
  }

  /// Returns "560 samples/s", with the limit set by the step's matrix products if they matter.
  [[nodiscard]] std::string rate(double samples_per_s) const {
    const double seconds_per_row = operations_per_row_ / (settings_.gflops * 1e9);
    const double percent = settings_.gflops > 0.0 ? 100.0 * samples_per_s * seconds_per_row : 0.0;
    if (percent < 1.0) return fmt::format("{:.0f} samples/s", samples_per_s);
    return fmt::format("{:.0f} samples/s, {:.0f} % of the {:.0f} that its matrix products alone allow",
                       samples_per_s, percent, 1.0 / seconds_per_row);
  }

  /// Updates the averaged weights. The average starts short, so that the initial weights lose influence soon.
  void average_in(double step) {
    if (average_.empty()) return;
    const double keep = std::min(settings_.recipe.average, (1.0 + step) / (10.0 + step));
    at::NoGradGuard no_gradients;
    for (std::size_t i = 0; i < weights_.size(); ++i) average_[i].lerp_(weights_[i], 1.0 - keep);
  }
  /// Exchanges the weights and their average.
  void swap_average() {
    at::NoGradGuard no_gradients;
    for (std::size_t i = 0; i < average_.size(); ++i) {
      const Tensor now = weights_[i].detach().clone();
      weights_[i].copy_(average_[i]);
      average_[i].copy_(now);
    }
  }

  /// Computes the epoch's validation error and keeps the weights if it is the least so far. `samples_per_s`:
  /// training rate of the epoch.
  void judge(double samples_per_s) {
    swap_average();
    judge_weights(samples_per_s);
    swap_average();
  }
  /// Returns LoopData::loss on the validation rows.
  double own_loss() {
    at::NoGradGuard no_gradients;
    data::BatchReader reader(data_.stream, {data_.validation.begin(), data_.validation.end()}, 512, 0,
                             data_.stream.validation());
    double sum = 0.0;
    for (data::Batch batch; reader.next(batch);) {
      const Tensor x = inputs_of(batch, data_.features, data_.guesses, data_.stream.labels().rows);
      sum += data_.loss(network_.forward(x, false), targets_of(batch.rows)).item<double>() *
             static_cast<double>(batch.rows.size());
    }
    return sum / static_cast<double>(data_.validation.size());
  }
  double squared_error() {
    const std::vector<float> out = predict(network_, data_.stream, data_.features, data_.validation,
                                           data_.guesses, data_.stream.validation());
    const float* weight = loss_weights_.data_ptr<float>();
    double sum = 0.0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto p = static_cast<std::size_t>(outputs_);
      const double e = out[i] - data_.targets[data_.validation[i / p] * p + i % p];
      sum += e * e * weight[i % p];
    }
    return sum / static_cast<double>(out.size());
  }
  void judge_weights(double samples_per_s) {
    const double error = data_.loss ? own_loss() : squared_error();
    const bool better = error < at_.best;
    curve_.push_back({at_.epoch + 1, at_.loss_sum / at_.rows, error, rate_});
    progress_.line(fmt::format("epoch {} of {}: loss {:.4f}, validation {:.4f}{}{}, {}", at_.epoch + 1,
                               settings_.recipe.epochs, at_.loss_sum / at_.rows, error,
                               better ? ", best so far" : "", data_.loss ? "" : " (scaled units)",
                               rate(samples_per_s)));
    ++at_.stale;
    if (!better) return;
    at_.best = error;
    at_.best_epoch = at_.epoch + 1;
    at_.stale = 0;
    for (std::size_t i = 0; i < weights_.size(); ++i) best_[i].copy_(weights_[i].detach());
  }

  Tensor targets_of(std::span<const std::uint64_t> rows) const {
    Tensor y = at::empty({static_cast<std::int64_t>(rows.size()), outputs_}, at::kFloat);
    for (std::size_t i = 0; i < rows.size(); ++i)
      std::copy_n(data_.targets.data() + rows[i] * static_cast<std::uint64_t>(outputs_), outputs_,
                  y.data_ptr<float>() + static_cast<std::int64_t>(i) * outputs_);
    return y;
  }

  [[nodiscard]] double seconds() const { return at_.seconds + seconds_since(begin_); }
  [[nodiscard]] double processor_seconds() const {
    return at_.processor_seconds + processor_time() - processor_begin_;
  }

  template <class Value>
  std::vector<std::span<Value>> arrays() {
    std::vector<Tensor> all = weights_;
    for (const auto& m : adam_.moments()) all.push_back(m);
    all.insert(all.end(), best_.begin(), best_.end());
    all.insert(all.end(), average_.begin(), average_.end());
    std::vector<std::span<Value>> spans;
    for (auto& t : all) spans.emplace_back(t.data_ptr<float>(), static_cast<std::size_t>(t.numel()));
    return spans;
  }

  void save() {
    last_save_ = Clock::now();
    if (settings_.checkpoint.empty()) return;
    const json header = {{"run", settings_.run ? *settings_.run : json()},
                         {"epoch", at_.epoch},
                         {"batch", at_.batch},
                         {"best_epoch", at_.best_epoch},
                         {"stale", at_.stale},
                         {"best", std::isfinite(at_.best) ? json(at_.best) : json()},
                         {"loss_sum", at_.loss_sum},
                         {"rows", at_.rows},
                         {"seconds", seconds()},
                         {"processor_seconds", processor_seconds()},
                         {"adam_steps", adam_.steps()},
                         {"learning_rate", rate_},
                         {"curve", learning_curve_json(curve_)}};
    write_checkpoint(settings_.checkpoint, header, arrays<const float>());
  }

  void resume() {
    if (settings_.checkpoint.empty()) return;
    json header;
    if (!read_checkpoint(settings_.checkpoint, settings_.run ? *settings_.run : json(), header,
                         arrays<float>()))
      return;
    at_ = {header.at("epoch"),
           header.at("batch"),
           header.at("best_epoch"),
           header.at("stale"),
           header.at("best").is_null() ? at_.best : header.at("best").get<double>(),
           header.at("loss_sum"),
           header.at("rows"),
           header.at("seconds"),
           header.at("processor_seconds")};
    adam_.set_steps(header.at("adam_steps"));
    rate_ = header.at("learning_rate");
    curve_ = read_learning_curve(header.at("curve"));
    if (settings_.epoch_done && !curve_.empty()) settings_.epoch_done(curve_);
    progress_.line(fmt::format("resumed at epoch {}, batch {}", at_.epoch + 1, at_.batch + 1));
  }

  networks::Network& network_;
  const LoopData& data_;
  const LoopSettings& settings_;
  TrainingProgress& progress_;
  std::vector<Tensor> weights_, best_, average_;  // average_: empty unless weights are averaged
  Adam adam_;
  Tensor loss_weights_;
  std::int64_t outputs_ = 0;
  std::size_t batches_ = 0;
  double operations_per_row_ = 0.0;  // matrix products of a training step; 0: not counted
  double rate_ = 0.0;                ///< learning rate of the last step
  LearningCurve curve_;
  Position at_;
  Clock::time_point begin_ = Clock::now(), last_save_ = Clock::now();
  double processor_begin_ = processor_time();
};

}  // namespace

LoopReport train_network(networks::Network& network, const LoopData& data, const LoopSettings& settings,
                         TrainingProgress& progress) {
  return Loop(network, data, settings, progress).run();
}

std::vector<float> predict(networks::Network& network, const data::ShardStream& stream,
                           const data::Features& features, std::span<const std::uint64_t> rows,
                           std::span<const float> guesses, const std::optional<data::Noise>& noise) {
  at::NoGradGuard no_gradients;
  data::BatchReader reader(stream, {rows.begin(), rows.end()}, 512, 0, noise);
  std::vector<float> out;
  for (data::Batch batch; reader.next(batch);) {
    const Tensor y =
        network.forward(inputs_of(batch, features, guesses, stream.labels().rows), false).contiguous();
    out.insert(out.end(), y.data_ptr<float>(), y.data_ptr<float>() + y.numel());
  }
  return out;
}

double learning_rate(const TrainingRecipe& recipe, std::uint64_t step, std::uint64_t steps) {
  if (recipe.schedule != "cosine") return recipe.learning_rate;
  const double all = static_cast<double>(steps), s = static_cast<double>(step);
  const double warm_up = std::min(1.0, (s + 1.0) / (0.02 * all + 1.0));
  return recipe.learning_rate * warm_up * (0.01 + 0.99 * 0.5 * (1.0 + std::cos(constants::pi * s / all)));
}

void seed_torch(std::uint64_t seed) {
  auto generator = at::globalContext().defaultGenerator(at::kCPU);
  generator.set_current_seed(seed);
}

}  // namespace swingbank::train::loop
