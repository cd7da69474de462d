#pragma once
// Rows of a dataset for training. Labels of all rows are always in memory; the series are kept there too when
// they fit, and are read block by block ahead of use otherwise. What comes out is the same either way.
#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <span>
#include <vector>

#include "mpi/store/dataset.hpp"
#include "train/data/downsample.hpp"
#include "train/data/noise.hpp"

namespace swingbank::train::data {

struct Labels {
  std::size_t rows = 0, parameters = 0;
  std::size_t judged = 0;      ///< rows of the dataset itself; those behind them only train
  std::vector<double> values;  ///< rows x parameters, raw units
  std::vector<std::uint64_t> sample_id;
  std::vector<std::int32_t> generator;  ///< bus number
};

struct StreamOptions {
  std::uint64_t memory_limit = std::uint64_t{8} << 30;  ///< [bytes]
  unsigned readers = 1;  ///< threads that read ahead; the bytes do not depend on it
  bool trust = false;    ///< do not compare the shards' hashes with the journal
  NoiseRecipe noise = {};
};

inline constexpr std::uint64_t kValidationDraw = std::uint64_t{1} << 32;  ///< no epoch reaches it

class ShardStream {
 public:
  /// Reads every shard once, a shard at a time, compares it with journal and header (read_checked), and keeps
  /// the labels, and the series if they fit. Trusting, it reads only what it keeps and checks only shapes and
  /// config. Throws InputError naming each shard at fault, and shard and row of a value that is not finite.
  /// `more`: a dataset whose rows follow and only train; it must hold the same channels, samples and
  /// parameters.
  ShardStream(mpi::store::Dataset dataset, const InputRecipe& recipe, const StreamOptions& options = {},
              const std::optional<mpi::store::Dataset>& more = {});

  /// Rows that are on no disk: takes the shards of the dataset that `header` describes from `next`, one after
  /// the other, keeps labels and series, and forgets the shard. The stream is that of the same dataset read
  /// from the disk. Throws InputError where the series do not fit into the memory limit.
  ShardStream(const mpi::store::DatasetHeader& header, const std::function<mpi::store::ShardData()>& next,
              const InputRecipe& recipe, const StreamOptions& options = {});

  [[nodiscard]] const mpi::store::Dataset& dataset() const { return dataset_; }
  /// Whether there are no records to go back to.
  [[nodiscard]] bool from_memory() const { return from_memory_; }
  /// The rows that only train, numbered on from the dataset's.
  [[nodiscard]] const std::optional<mpi::store::Dataset>& more() const { return more_; }
  [[nodiscard]] const InputSelection& selection() const { return selection_; }
  [[nodiscard]] const Labels& labels() const { return labels_; }
  [[nodiscard]] std::size_t channels() const { return selection_.outputs(); }
  [[nodiscard]] std::size_t samples() const { return selection_.samples; }
  [[nodiscard]] const NoiseRecipe& noise() const { return options_.noise; }
  /// The noise that rows are judged with.
  [[nodiscard]] Noise judged() const { return {noise().level}; }
  /// The noise of an epoch of training: that of judging, unless rows draw their levels.
  [[nodiscard]] Noise training(std::uint64_t epoch) const {
    return noise().training ? Noise{{}, epoch} : judged();
  }
  /// The noise of rows that decide when to stop: the same in every epoch.
  [[nodiscard]] Noise validation() const { return training(kValidationDraw); }
  /// Whether the series are there as they are read; records whose noise changes are not.
  [[nodiscard]] bool in_memory() const { return !series_.empty(); }
  /// rows: row numbers of the dataset, in any order; out: rows x values of the selection. Another noise than
  /// that of judging needs a recipe with levels of training.
  void read(std::span<const std::uint64_t> rows, float* out, const Noise& noise) const;
  void read(std::span<const std::uint64_t> rows, float* out) const { read(rows, out, judged()); }

 private:
  void append(mpi::store::Dataset more);
  void load(const mpi::store::ShardInfo& shard, bool fits);
  void take(const mpi::store::ShardData& shard);
  void require_rows() const;
  /// Values kept of a row in memory.
  [[nodiscard]] std::size_t kept() const;
  void keep_labels(const mpi::store::RowBlock& block, const mpi::store::ShardInfo& shard);
  void keep_series(const mpi::store::RowBlock& block, const mpi::store::ShardInfo& shard);
  /// The series of a record, which is the dataset's row `row`, with its noise.
  void series_of(const float* record, const mpi::store::ShardInfo& shard, std::uint64_t row,
                 const Noise& noise, float* out) const;
  /// Reads one run of rows of a shard and copies those asked for.
  struct Wanted {
    std::uint64_t row;
    std::size_t slot;
  };
  void read_run(std::span<const Wanted> run, const Noise& noise, float* out) const;
  [[nodiscard]] const mpi::store::ShardInfo& shard_of(std::uint64_t row) const;
  void check_finite(const float* series, const mpi::store::ShardInfo& shard, std::uint64_t row) const;

  mpi::store::Dataset dataset_;
  std::optional<mpi::store::Dataset> more_;
  std::vector<mpi::store::ShardInfo> shards_;  ///< of both, rows counted on
  std::size_t rows_ = 0;
  bool from_memory_ = false;
  InputSelection selection_;
  StreamOptions options_;
  RecordNoise noise_;
  Labels labels_;
  std::vector<float> series_;   ///< as they are read; or
  std::vector<float> records_;  ///< as they are stored, where their noise changes; or neither
};

/// Order in which an epoch visits `rows` (ascending): blocks of 256 neighbours are shuffled, then the rows
/// within each window of 64 blocks. Depends on rows, seed and epoch only; sets below 16,384 rows are shuffled
/// fully.
std::vector<std::uint64_t> epoch_order(std::span<const std::uint64_t> rows, std::uint64_t seed,
                                       std::uint64_t epoch);

struct Batch {
  std::span<const std::uint64_t> rows;
  std::vector<float> series;  ///< rows x channels x samples
};

/// Batches of one epoch, read ahead by one chunk where the series are not in memory.
class BatchReader {
 public:
  /// Starts at batch `first` of the order; reads with the noise of judging unless told another.
  BatchReader(const ShardStream& stream, std::vector<std::uint64_t> order, std::size_t batch,
              std::size_t first = 0, const std::optional<Noise>& noise = {});
  /// False at the end.
  bool next(Batch& out);
  [[nodiscard]] std::size_t batches() const { return (order_.size() + batch_ - 1) / batch_; }

 private:
  void start_reading(std::size_t from);

  const ShardStream& stream_;
  std::vector<std::uint64_t> order_;
  Noise noise_;
  std::size_t batch_, position_, chunk_, chunk_begin_ = 0, chunk_end_ = 0;
  std::vector<float> current_;
  std::future<std::vector<float>> ahead_;
  std::size_t ahead_begin_ = 0, ahead_end_ = 0;
};

}  // namespace swingbank::train::data
