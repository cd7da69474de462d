#include "train/data/shard_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "base/in_parallel.hpp"
#include "base/problem.hpp"
#include "mpi/store/shard_apart.hpp"
#include "train/data/random.hpp"

namespace swingbank::train::data {
namespace {
mpi::store::Dataset without_shards(const mpi::store::DatasetHeader& header) {
  mpi::store::Dataset d;
  static_cast<mpi::store::DatasetHeader&>(d) = header;
  d.path = header.name;
  d.complete = true;
  return d;
}
constexpr std::size_t kBlock = 256, kWindow = 64;  // rows per block, blocks per window
constexpr std::uint64_t kLongestRun = 1024, kLargestGap = 64;
constexpr mpi::store::ShardFields kRecordsOnly{
    .records = true, .parameters = false, .angle_valid = false, .draws = false};
}  // namespace

ShardStream::ShardStream(mpi::store::Dataset dataset, const InputRecipe& recipe, const StreamOptions& options,
                         const std::optional<mpi::store::Dataset>& more)
    : dataset_(std::move(dataset)),
      shards_(dataset_.shards),
      rows_(dataset_.rows),
      selection_(select_input(recipe, dataset_)),
      options_(options),
      noise_(dataset_, options.noise) {
  require_rows();
  labels_.parameters = dataset_.parameter_names.size();
  labels_.judged = rows_;
  if (more) append(*more);
  const bool fits = rows_ <= options_.memory_limit / (kept() * sizeof(float));
  Problems problems;
  for (const auto& shard : shards_) {
    try {
      load(shard, fits);
    } catch (const InputError& e) {
      problems.add(e);
    }
  }
  problems.raise();
  labels_.rows = rows_;
}

ShardStream::ShardStream(const ShardSource& source, const InputRecipe& recipe, const StreamOptions& options,
                         const ShardSource* more)
    : dataset_(without_shards(source.header)),
      from_memory_(true),
      selection_(select_input(recipe, dataset_)),
      options_(options),
      noise_(dataset_, options.noise) {
  labels_.parameters = dataset_.parameter_names.size();
  take_all(source, dataset_);
  require_rows();
  labels_.judged = rows_;
  if (more != nullptr) {
    more_ = without_shards(more->header);
    require_same(*more_);
    take_all(*more, *more_);
  }
  labels_.rows = rows_;
}

void ShardStream::take_all(const ShardSource& source, mpi::store::Dataset& into) {
  for (std::uint64_t k = 0; k < source.header.shard_count(); ++k) take(source.next(), into);
  into.hash = mpi::store::dataset_hash(into.shards);
}

void ShardStream::take(const mpi::store::ShardData& shard, mpi::store::Dataset& into) {
  into.shards.push_back(mpi::store::info_of(into, shard, into.rows));
  mpi::store::ShardInfo info = into.shards.back();
  info.first_row = rows_;
  rows_ += shard.rows;
  into.rows += shard.rows;
  if (rows_ > options_.memory_limit / (kept() * sizeof(float)))
    throw InputError(
        {fmt::format("too little memory for the rows of {}", into.name), fmt::format("shard {}", info.shard),
         fmt::format("{} rows of {} values are more than {:.1f} GB", rows_, kept(),
                     static_cast<double>(options_.memory_limit) * 1e-9),
         "raise --memory-limit, lower --draws, or write the dataset to disk with `swingbank generate`"});
  shards_.push_back(info);
  keep_labels(shard, info);
  keep_series(shard, info);
  for (const auto& [name, count] : info.outcomes) into.outcomes[name] += count;
}

void ShardStream::require_rows() const {
  if (dataset_.rows == 0)
    throw InputError({"no rows", dataset_.path.string(), "every draw was rejected, or none was made",
                      "see the outcomes in the dataset's journal and the ranges in its config"});
}

std::size_t ShardStream::kept() const {
  return options_.noise.training ? dataset_.channel_names.size() * dataset_.samples : selection_.values();
}

void ShardStream::require_same(const mpi::store::Dataset& more) const {
  const mpi::store::Dataset& d = dataset_;
  const auto filter = [](const mpi::store::Dataset& of) {
    return mpi::store::config_numbers(of, "record.frequency");
  };
  const auto start = [](const mpi::store::Dataset& of) {
    return mpi::store::config_numbers(of, "fault.start");
  };
  Problems problems;
  const auto same = [&](bool equal, const char* what) {
    if (!equal)
      problems.add(std::string("a different ") + what, more.path.string(),
                   "it must be the same as in " + d.path.string(),
                   "generate the training dataset from a config with the same [record] and [vary]");
  };
  same(more.channel_names == d.channel_names, "list of channels");
  same(more.rate == d.rate && more.samples == d.samples, "rate or length");
  same(filter(more) == filter(d), "frequency filter");
  same(start(more) == start(d), "start of the fault");
  same(more.machine_model == d.machine_model && more.parameter_names == d.parameter_names,
       "list of parameters");
  same(more.parameter_low == d.parameter_low && more.parameter_high == d.parameter_high, "sampling box");
  problems.raise();
}

void ShardStream::append(mpi::store::Dataset more) {
  require_same(more);
  for (mpi::store::ShardInfo& shard : more.shards) {
    shard.first_row += rows_;
    shards_.push_back(shard);
  }
  rows_ += more.rows;
  more_ = std::move(more);
}

void ShardStream::load(const mpi::store::ShardInfo& shard, bool fits) {
  mpi::store::RowBlock block;
  if (options_.trust)  // read without verification of the hash
    block = mpi::store::read_shard_apart(
        shard, {.records = fits, .parameters = true, .angle_valid = false, .draws = false});
  else
    block = mpi::store::read_checked(shard);
  keep_labels(block, shard);
  if (fits) keep_series(block, shard);
}

void ShardStream::keep_labels(const mpi::store::RowBlock& block, const mpi::store::ShardInfo& shard) {
  Problems problems;
  for (std::size_t i = 0; i < block.parameters.size(); ++i)
    if (!std::isfinite(block.parameters[i]))
      problems.add(
          fmt::format("parameter {} is not a number", dataset_.parameter_names[i % labels_.parameters]),
          fmt::format("{}, row {}", shard.path.string(), i / labels_.parameters),
          "a network cannot be trained on it", "generate this shard again");
  problems.raise();
  labels_.values.insert(labels_.values.end(), block.parameters.begin(), block.parameters.end());
  labels_.sample_id.insert(labels_.sample_id.end(), block.sample_id.begin(), block.sample_id.end());
  labels_.generator.insert(labels_.generator.end(), block.generator.begin(), block.generator.end());
}

void ShardStream::series_of(const float* record, const mpi::store::ShardInfo& shard, std::uint64_t row,
                            const Noise& noise, float* out) const {
  const double level = noise_.level(row, noise);
  std::vector<float> noisy;
  if (level > 0) {
    noisy.assign(record, record + dataset_.channel_names.size() * dataset_.samples);
    noise_.add(row, noise, noisy.data());
    record = noisy.data();
  }
  selection_.apply(record, dataset_.samples, level, selection_.swing ? reactance(row) : 0, out);
  check_finite(out, shard, row);
}

double ShardStream::reactance(std::uint64_t row) const {
  const mpi::store::Dataset& d = row < labels_.judged || !more_ ? dataset_ : *more_;
  const auto machine = std::ranges::find(d.generators, labels_.generator[row]) - d.generators.begin();
  const auto name = std::ranges::find(d.held_names, "Xdp") - d.held_names.begin();
  return d.held.at(static_cast<std::size_t>(machine)).at(static_cast<std::size_t>(name));
}

void ShardStream::keep_series(const mpi::store::RowBlock& block, const mpi::store::ShardInfo& shard) {
  if (options_.noise.training) {
    if (records_.empty() && !from_memory_) records_.reserve(rows_ * block.channels * block.samples);
    records_.insert(records_.end(), block.records.begin(), block.records.end());
    return;
  }
  const std::size_t values = selection_.values();
  if (series_.empty() && !from_memory_) series_.reserve(rows_ * values);
  const std::size_t before = series_.size();
  series_.resize(before + block.rows * values);
  for (std::size_t i = 0; i < block.rows; ++i)
    series_of(block.records.data() + i * block.channels * block.samples, shard, shard.first_row + i, judged(),
              series_.data() + before + i * values);
}

const mpi::store::ShardInfo& ShardStream::shard_of(std::uint64_t row) const {
  const auto after =
      std::upper_bound(shards_.begin(), shards_.end(), row,
                       [](std::uint64_t r, const mpi::store::ShardInfo& s) { return r < s.first_row; });
  return *std::prev(after);
}

void ShardStream::check_finite(const float* series, const mpi::store::ShardInfo& shard,
                               std::uint64_t row) const {
  for (std::size_t i = 0; i < selection_.values(); ++i)
    if (!std::isfinite(series[i]))
      throw InputError(
          {fmt::format(
               "channel {} holds a value that is not a number",
               dataset_
                   .channel_names[selection_.channels[i / selection_.samples % selection_.channels.size()]]),
           fmt::format("{}, row {}", shard.path.string(), row - shard.first_row),
           "a network cannot be trained on it", "generate this shard again"});
}

void ShardStream::read_run(std::span<const Wanted> run, const Noise& noise, float* out) const {
  const mpi::store::ShardInfo& shard = shard_of(run.front().row);
  const std::uint64_t first = run.front().row, count = run.back().row - first + 1;
  mpi::store::RowBlock block;
  mpi::store::read_rows(shard, first - shard.first_row, count, block, kRecordsOnly);
  const std::size_t values = selection_.values();
  for (const auto& w : run)
    series_of(block.records.data() + (w.row - first) * block.channels * block.samples, shard, w.row, noise,
              out + w.slot * values);
}

void ShardStream::read(std::span<const std::uint64_t> rows, float* out, const Noise& noise) const {
  const std::size_t values = selection_.values();
  if (!records_.empty()) {
    const std::size_t record = dataset_.channel_names.size() * dataset_.samples;
    const auto one = [&](std::size_t i) {
      series_of(records_.data() + rows[i] * record, shard_of(rows[i]), rows[i], noise, out + i * values);
    };
    return in_parallel(rows.size(), one, [](int) {});
  }
  if (in_memory()) {
    for (std::size_t i = 0; i < rows.size(); ++i)
      std::copy_n(series_.data() + rows[i] * values, values, out + i * values);
    return;
  }
  std::vector<Wanted> wanted(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) wanted[i] = {rows[i], i};
  std::sort(wanted.begin(), wanted.end(), [](const Wanted& a, const Wanted& b) { return a.row < b.row; });
  std::vector<std::span<const Wanted>> runs;
  for (std::size_t begin = 0, i = 1; i <= wanted.size(); ++i) {
    const bool joins = i < wanted.size() && wanted[i].row - wanted[i - 1].row <= kLargestGap &&
                       wanted[i].row - wanted[begin].row < kLongestRun &&
                       &shard_of(wanted[i].row) == &shard_of(wanted[begin].row);
    if (joins) continue;
    runs.emplace_back(wanted.data() + begin, i - begin);
    begin = i;
  }
  const unsigned readers = std::max(1u, options_.readers);
  std::vector<std::future<void>> workers;
  for (unsigned w = 0; w < readers; ++w)
    workers.push_back(std::async(readers == 1 ? std::launch::deferred : std::launch::async, [&, w] {
      for (std::size_t i = w; i < runs.size(); i += readers) read_run(runs[i], noise, out);
    }));
  for (auto& worker : workers) worker.wait();
  for (auto& worker : workers) worker.get();
}

std::vector<std::uint64_t> epoch_order(std::span<const std::uint64_t> rows, std::uint64_t seed,
                                       std::uint64_t epoch) {
  const std::size_t blocks = (rows.size() + kBlock - 1) / kBlock;
  std::vector<std::size_t> block_order(blocks);
  for (std::size_t i = 0; i < blocks; ++i) block_order[i] = i;
  shuffle(block_order, key(seed, Purpose::order, epoch));
  std::vector<std::uint64_t> order;
  order.reserve(rows.size());
  for (std::size_t begin = 0; begin < blocks; begin += kWindow) {
    const std::size_t start = order.size();
    for (std::size_t i = begin; i < std::min(begin + kWindow, blocks); ++i) {
      const std::size_t from = block_order[i] * kBlock;
      order.insert(order.end(), rows.begin() + static_cast<std::ptrdiff_t>(from),
                   rows.begin() + static_cast<std::ptrdiff_t>(std::min(from + kBlock, rows.size())));
    }
    shuffle(order.data() + start, order.size() - start, key(seed, Purpose::order, epoch, begin + 1));
  }
  return order;
}

BatchReader::BatchReader(const ShardStream& stream, std::vector<std::uint64_t> order, std::size_t batch,
                         std::size_t first, const std::optional<Noise>& noise)
    : stream_(stream),
      order_(std::move(order)),
      noise_(noise.value_or(stream.judged())),
      batch_(batch),
      position_(std::min(first * batch, order_.size())) {
  chunk_ = std::max<std::size_t>(1, kBlock * kWindow / 4 / batch_) * batch_;
  if (!stream_.in_memory()) start_reading(position_);
}

void BatchReader::start_reading(std::size_t from) {
  ahead_begin_ = from;
  ahead_end_ = std::min(from + chunk_, order_.size());
  if (ahead_begin_ == ahead_end_) return;
  ahead_ = std::async(std::launch::async, [this, begin = ahead_begin_, end = ahead_end_] {
    std::vector<float> series((end - begin) * stream_.selection().values());
    stream_.read({order_.data() + begin, end - begin}, series.data(), noise_);
    return series;
  });
}

bool BatchReader::next(Batch& out) {
  if (position_ >= order_.size()) return false;
  const std::size_t count = std::min(batch_, order_.size() - position_),
                    values = stream_.selection().values();
  out.rows = {order_.data() + position_, count};
  out.series.resize(count * values);
  if (stream_.in_memory()) {
    stream_.read(out.rows, out.series.data(), noise_);
  } else {
    if (position_ >= chunk_end_) {
      current_ = ahead_.get();
      chunk_begin_ = ahead_begin_;
      chunk_end_ = ahead_end_;
      start_reading(chunk_end_);
    }
    std::copy_n(current_.data() + (position_ - chunk_begin_) * values, count * values, out.series.data());
  }
  position_ += count;
  return true;
}

}  // namespace swingbank::train::data
