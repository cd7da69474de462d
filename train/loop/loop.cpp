#include "train/loop/loop.hpp"

#include <ATen/ATen.h>
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <optional>

#include "base/constants.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/stop_signal.hpp"
#include "mpi/items/one_process.hpp"
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

/// Returns the features of the rows. If `guesses` is not empty, appends each row's guesses; a row is then one
/// channel.
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

/// Progress of a run, which a checkpoint stores beside the arrays.
struct Position {
  std::size_t epoch = 0, batch = 0;  ///< next epoch and batch, from 0
  std::size_t best_epoch = 0, stale = 0;
  double best = std::numeric_limits<double>::infinity();
  double loss_sum = 0.0;  ///< sum of the losses of this epoch so far, weighted by rows
  double rows = 0.0, seconds = 0.0, processor_seconds = 0.0;
};

/// Returns the elements at positions first, first + stride, ...
std::vector<std::uint64_t> every(std::span<const std::uint64_t> all, std::size_t first, std::size_t stride) {
  std::vector<std::uint64_t> some;
  for (std::size_t i = first; i < all.size(); i += stride) some.push_back(all[i]);
  return some;
}

class Loop {
 public:
  Loop(networks::Network& network, const LoopData& data, const LoopSettings& settings,
       TrainingProgress& progress)
      : network_(network),
        data_(data),
        settings_(settings),
        progress_(progress),
        ranks_(settings.ranks == nullptr ? alone_ : *settings.ranks),
        rank_(static_cast<std::size_t>(ranks_.rank())),
        size_(static_cast<std::size_t>(ranks_.size())),
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
    own_validation_ = every(data.validation, rank_, size_);
  }

  LoopReport run() {
    resume();
    bool saved = false;
    while (at_.epoch < settings_.recipe.epochs && at_.stale < settings_.recipe.patience && !saved)
      saved = !epoch();
    std::array<float, 1> processor = {static_cast<float>(unsummed_processor_time())};
    ranks_.sum(processor);
    at_.processor_seconds += static_cast<double>(processor[0]);
    const double spent = seconds();
    if (!saved) {
      at::NoGradGuard no_gradients;
      for (std::size_t i = 0; i < weights_.size(); ++i) weights_[i].copy_(best_[i]);
    }
    return {!saved, at_.epoch, at_.best_epoch, spent, at_.best, at_.processor_seconds, curve_};
  }

 private:
  /// Gets the epoch's training rows if they change. Returns false if a rank was asked to stop.
  bool take_rows() {
    if (!data_.fresh || at_.epoch == 0) return true;
    fresh_.reset();  // before the new rows, so that memory holds those of one epoch
    progress_.line(fmt::format("epoch {} of {}: new training rows", at_.epoch + 1, settings_.recipe.epochs));
    ranks_.agree("the training rows", [&] { fresh_ = data_.fresh(at_.epoch); });
    std::array<float, 1> stopped = {fresh_ ? 0.0f : 1.0f};
    ranks_.sum(stopped);
    return stopped[0] == 0.0f;
  }

  /// Trains one epoch. If the run is asked to stop, saves a checkpoint and returns false.
  bool epoch() {
    if (!take_rows()) {
      save();
      return false;
    }
    const data::ShardStream& stream = fresh_ ? *fresh_->stream : data_.stream;
    std::vector<std::uint64_t> order =
        data::epoch_order(fresh_ ? fresh_->rows : data_.train, settings_.seed, at_.epoch);
    order.resize(std::min(order.size(), data_.train.size()));
    const std::size_t whole = settings_.recipe.batch;
    std::vector<std::uint64_t> own;
    for (std::size_t begin = 0; begin < order.size(); begin += whole)
      for (std::size_t i = rank_; i < std::min(whole, order.size() - begin); i += size_)
        own.push_back(order[begin + i]);
    data::BatchReader reader(stream, std::move(own), (whole - rank_ + size_ - 1) / size_, at_.batch,
                             stream.training(settings_.first_draw + at_.epoch));
    const auto begin = Clock::now();
    const double before = at_.rows;
    while (at_.batch * whole < order.size()) {
      const bool stop = settings_.stop ? settings_.stop() : stop_asked();
      if (size_ == 1 && stop) {
        save();
        return false;
      }
      data::Batch batch;  // the last batch of an epoch may have no row for this rank
      const std::size_t rows = std::min(whole, order.size() - at_.batch * whole);
      if (rank_ < rows) reader.next(batch);
      if (step(batch, rows, stop)) {
        save();
        return false;
      }
      if (seconds_since(last_save_) > settings_.checkpoint_every_s) save();
    }
    judge((at_.rows - before) / seconds_since(begin));
    if (settings_.epoch_done && rank_ == 0) settings_.epoch_done(curve_);
    ++at_.epoch;
    at_.batch = 0;
    at_.loss_sum = at_.rows = 0.0;
    if (seconds_since(last_save_) >= settings_.checkpoint_after_epoch_s) save();
    return true;
  }

  /// Performs one step. batch: this rank's rows; rows: number of rows of all ranks; stop: whether this rank
  /// was asked to stop. Returns whether any rank was asked to stop.
  bool step(const data::Batch& batch, std::size_t rows, bool stop) {
    StepSums sums{0.0, stop};
    if (!batch.rows.empty()) sums.loss = add_gradients(batch, static_cast<double>(rows));
    if (size_ > 1) sum_gradients(sums);
    const double value = sums.loss;
    if (!std::isfinite(value))
      throw InputError({"the training loss is not a number",
                        fmt::format("epoch {}, batch {}", at_.epoch + 1, at_.batch + 1),
                        "the weights have diverged", "lower learning_rate in the experiment"});
    const auto done = at_.epoch * batches_ + at_.batch;
    const TrainingRecipe& recipe = settings_.recipe;
    rate_ = learning_rate(recipe, done, recipe.epochs * batches_);
    adam_.step(rate_, recipe.weight_decay, recipe.clip);
    average_in(static_cast<double>(done));
    at_.loss_sum += value * static_cast<double>(rows);
    at_.rows += static_cast<double>(rows);
    ++at_.batch;
    progress_.update(at_.epoch * data_.train.size() + static_cast<std::uint64_t>(at_.rows),
                     fmt::format("epoch {} of {}, loss {:.4f}", at_.epoch + 1, settings_.recipe.epochs,
                                 at_.loss_sum / at_.rows));
    return sums.stop;
  }

  /// Values of a step that are summed over the ranks: mean loss of the batch, and whether a rank was asked to
  /// stop.
  struct StepSums {
    double loss = 0.0;
    bool stop = false;
  };

  /// Computes the gradients of this rank's part of the batch's mean loss. `rows`: number of rows of the whole
  /// batch. Returns this rank's part of the loss.
  double add_gradients(const data::Batch& batch, double rows) {
    const networks::StepRows place{data::key(settings_.seed, data::Purpose::dropout, at_.epoch, at_.batch),
                                   rank_, size_};
    std::optional<runtime::ProductCount> count;
    if (settings_.gflops > 0.0 && operations_per_row_ == 0.0) count.emplace();
    const auto own = static_cast<double>(batch.rows.size());
    const Tensor loss = loss_of(
        network_.forward(inputs_of(batch, data_.features, data_.guesses, data_.stream.labels().rows), &place),
        targets_of(batch.rows, fresh_ ? fresh_->targets : data_.targets));
    (loss * (own / rows)).backward();
    if (count) operations_per_row_ = count->operations() / own;
    return loss.item<double>() * own / rows;
  }

  /// Sums the gradients and the step's values over the ranks, in one message. For each weight tensor, the
  /// message contains 1 or 0 for whether this rank has its gradient, then the gradient, or zeros.
  void sum_gradients(StepSums& sums) {
    buffer_.clear();
    for (const Tensor& w : weights_) {
      const bool has = w.grad().defined();
      buffer_.push_back(has ? 1.0f : 0.0f);
      buffer_.resize(buffer_.size() + static_cast<std::size_t>(w.numel()));
      float* to = buffer_.data() + buffer_.size() - w.numel();
      if (!has) continue;
      const Tensor gradient = w.grad().contiguous();
      std::copy_n(gradient.data_ptr<float>(), w.numel(), to);
    }
    buffer_.insert(buffer_.end(), {static_cast<float>(sums.loss), sums.stop ? 1.0f : 0.0f,
                                   static_cast<float>(unsummed_processor_time())});
    ranks_.sum(buffer_);
    const float* from = buffer_.data();
    for (Tensor& w : weights_) {
      const bool has = *from++ > 0.0f;
      if (has && !w.grad().defined()) w.mutable_grad() = at::empty_like(w);
      if (has && !w.grad().is_contiguous()) w.mutable_grad() = w.grad().contiguous();
      if (has) std::copy_n(from, w.numel(), w.grad().data_ptr<float>());
      from += w.numel();
    }
    sums = {static_cast<double>(from[0]), from[1] > 0.0f};
    at_.processor_seconds += static_cast<double>(from[2]);
  }

  /// Returns this rank's processor time since the last call [core-s].
  double unsummed_processor_time() {
    const double now = processor_time();
    return now - std::exchange(processor_begin_, now);
  }

  [[nodiscard]] Tensor loss_of(const Tensor& out, const Tensor& targets) const {
    if (data_.loss) return data_.loss(out, targets);
    if (const Tensor own = network_.loss(out, targets); own.defined()) return own;
    return ((out - targets).square() * loss_weights_).mean();
  }

  /// Returns "560 samples/s", followed by the limit that the matrix products impose, if they take a relevant
  /// share of the time.
  [[nodiscard]] std::string rate(double samples_per_s) const {
    const double seconds_per_row =
        operations_per_row_ / (settings_.gflops * 1e9 * static_cast<double>(size_));
    const double percent = settings_.gflops > 0.0 ? 100.0 * samples_per_s * seconds_per_row : 0.0;
    if (percent < 1.0) return fmt::format("{:.0f} samples/s", samples_per_s);
    return fmt::format("{:.0f} samples/s, {:.0f} % of the {:.0f} that the matrix products alone allow",
                       samples_per_s, percent, 1.0 / seconds_per_row);
  }

  /// Updates the averaged weights. The averaging time is short at first, so that the initial weights soon
  /// lose influence.
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

  /// Computes the epoch's validation error and stores the weights if it is the smallest so far.
  /// `samples_per_s`: training rate of the epoch.
  void judge(double samples_per_s) {
    swap_average();
    judge_weights(samples_per_s);
    swap_average();
  }
  /// Returns the sum of LoopData::loss over this rank's validation rows.
  double sum_of_losses() {
    at::NoGradGuard no_gradients;
    data::BatchReader reader(data_.stream, own_validation_, 512, 0, data_.stream.validation());
    double sum = 0.0;
    for (data::Batch batch; reader.next(batch);) {
      const Tensor x = inputs_of(batch, data_.features, data_.guesses, data_.stream.labels().rows);
      sum += data_.loss(network_.forward(x, nullptr), targets_of(batch.rows, data_.targets)).item<double>() *
             static_cast<double>(batch.rows.size());
    }
    return sum;
  }
  /// Returns the sum over this rank's validation rows of the mean squared error of a row's outputs.
  double sum_of_squares() {
    const std::vector<float> out = predict(network_, data_.stream, data_.features, own_validation_,
                                           data_.guesses, data_.stream.validation());
    const float* weight = loss_weights_.data_ptr<float>();
    double sum = 0.0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto p = static_cast<std::size_t>(outputs_);
      const double e = out[i] - data_.targets[own_validation_[i / p] * p + i % p];
      sum += e * e * weight[i % p];
    }
    return sum / static_cast<double>(outputs_);
  }
  double validation_error() {
    double sum = data_.loss ? sum_of_losses() : sum_of_squares();
    if (size_ > 1) {
      std::array<float, 1> total = {static_cast<float>(sum)};
      ranks_.sum(total);
      sum = static_cast<double>(total[0]);
    }
    return sum / static_cast<double>(data_.validation.size());
  }
  void judge_weights(double samples_per_s) {
    const double error = validation_error();
    if (!std::isfinite(error))
      throw InputError({"the validation loss is not a number", fmt::format("epoch {}", at_.epoch + 1),
                        "the weights have diverged", "lower learning_rate in the experiment"});
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

  /// Returns the targets of rows. `all`: targets of all rows of their stream.
  Tensor targets_of(std::span<const std::uint64_t> rows, std::span<const float> all) const {
    Tensor y = at::empty({static_cast<std::int64_t>(rows.size()), outputs_}, at::kFloat);
    for (std::size_t i = 0; i < rows.size(); ++i)
      std::copy_n(all.data() + rows[i] * static_cast<std::uint64_t>(outputs_), outputs_,
                  y.data_ptr<float>() + static_cast<std::int64_t>(i) * outputs_);
    return y;
  }

  [[nodiscard]] double seconds() const { return at_.seconds + seconds_since(begin_); }

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
    if (size_ == 1) at_.processor_seconds += unsummed_processor_time();
    if (settings_.checkpoint.empty() || rank_ != 0) return;
    const json header = {{"run", settings_.run ? *settings_.run : json()},
                         {"epoch", at_.epoch},
                         {"batch", at_.batch},
                         {"best_epoch", at_.best_epoch},
                         {"stale", at_.stale},
                         {"best", std::isfinite(at_.best) ? json(at_.best) : json()},
                         {"loss_sum", at_.loss_sum},
                         {"rows", at_.rows},
                         {"seconds", seconds()},
                         {"processor_seconds", at_.processor_seconds},
                         {"adam_steps", adam_.steps()},
                         {"learning_rate", rate_},
                         {"curve", learning_curve_json(curve_)}};
    write_checkpoint(settings_.checkpoint, header, arrays<const float>());
  }

  void resume() {
    if (settings_.checkpoint.empty()) return;
    json header;
    bool found = false;
    ranks_.agree(settings_.checkpoint.string(), [&] {
      found = rank_ == 0 && read_checkpoint(settings_.checkpoint, settings_.run ? *settings_.run : json(),
                                            header, arrays<float>());
    });
    if (ranks_.from_first(found ? 1 : 0) == 0) return;
    std::string text = header.dump();
    text.resize(static_cast<std::size_t>(ranks_.from_first(static_cast<int>(text.size()))));
    ranks_.copy_from_first(std::as_writable_bytes(std::span(text)));
    header = json::parse(text);
    for (const auto& array : arrays<float>()) ranks_.copy_from_first(std::as_writable_bytes(array));
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
    if (settings_.epoch_done && !curve_.empty() && rank_ == 0) settings_.epoch_done(curve_);
    progress_.line(fmt::format("resumed at epoch {}, batch {}", at_.epoch + 1, at_.batch + 1));
  }

  networks::Network& network_;
  const LoopData& data_;
  const LoopSettings& settings_;
  TrainingProgress& progress_;
  mpi::items::OneProcess alone_;
  const mpi::items::Ranks& ranks_;
  std::size_t rank_, size_;
  std::vector<std::uint64_t> own_validation_;     // validation rows of this rank
  std::optional<EpochRows> fresh_;                // none in an epoch on the rows LoopData::train
  std::vector<float> buffer_;                     // message of sum_gradients
  std::vector<Tensor> weights_, best_, average_;  // average_: empty unless weights are averaged
  Adam adam_;
  Tensor loss_weights_;
  std::int64_t outputs_ = 0;
  std::size_t batches_ = 0;
  double operations_per_row_ = 0.0;  // operations of matrix products; 0: not counted
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
                           std::span<const float> guesses, const std::optional<data::Noise>& noise,
                           const std::function<void(std::size_t)>& computed) {
  at::NoGradGuard no_gradients;
  data::BatchReader reader(stream, {rows.begin(), rows.end()}, 512, 0, noise);
  std::vector<float> out;
  std::size_t done = 0;
  for (data::Batch batch; reader.next(batch);) {
    if (computed) computed(done);
    done += batch.rows.size();
    const Tensor y =
        network.forward(inputs_of(batch, features, guesses, stream.labels().rows), nullptr).contiguous();
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
