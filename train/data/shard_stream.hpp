#pragma once
// Access to a dataset's rows for training. The labels of all rows are always in memory. The rows' series
// (signals that form the network's input) are kept in memory if they fit. Otherwise they are read in blocks
// ahead of use, with the same result.
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
  std::size_t judged = 0;      ///< rows of the dataset itself; later rows are never test rows
  std::vector<double> values;  ///< rows x parameters, raw units
  std::vector<std::uint64_t> sample_id;
  std::vector<std::int32_t> generator;  ///< bus number
};

struct StreamOptions {
  std::uint64_t memory_limit = std::uint64_t{8} << 30;  ///< [bytes]
  unsigned readers = 1;  ///< read-ahead threads; the result does not depend on their number
  bool trust = false;    ///< skip the comparison of shard hashes with the journal
  NoiseRecipe noise = {};
};

/// Dataset whose shards come from a function instead of from disk.
struct ShardSource {
  const mpi::store::DatasetHeader& header;
  std::function<mpi::store::ShardData()> next;  ///< returns the shards in order of their numbers
};

inline constexpr std::uint64_t kValidationDraw =
    std::uint64_t{1} << 32;  ///< noise of validation rows, above any epoch's number

class ShardStream {
 public:
  /// Reads every shard once and compares it with journal and header (read_checked). Keeps the labels, and the
  /// series if they fit. With `trust`, reads only what it keeps and checks only shapes and config. Throws
  /// InputError that names each invalid shard, and the shard and row of each value that is not finite.
  /// `more`: a dataset with further rows, which are never test rows; it must have the same channels, samples
  /// and parameters.
  ShardStream(mpi::store::Dataset dataset, const InputRecipe& recipe, const StreamOptions& options = {},
              const std::optional<mpi::store::Dataset>& more = {});

  /// Takes the shards from sources instead of from disk. Keeps labels and series and discards the shards. The
  /// stream equals that of the same datasets read from disk. Throws InputError if the series exceed the
  /// memory limit.
  ShardStream(const ShardSource& source, const InputRecipe& recipe, const StreamOptions& options = {},
              const ShardSource* more = nullptr);

  [[nodiscard]] const mpi::store::Dataset& dataset() const { return dataset_; }
  /// Returns whether the dataset is only in memory and has no complete records on disk.
  [[nodiscard]] bool from_memory() const { return from_memory_; }
  [[nodiscard]] const StreamOptions& options() const { return options_; }
  /// Returns the memory that series or records take [bytes].
  [[nodiscard]] std::uint64_t bytes() const { return (series_.size() + records_.size()) * sizeof(float); }
  /// Returns the dataset of the further rows. Its row numbers follow those of the first dataset.
  [[nodiscard]] const std::optional<mpi::store::Dataset>& more() const { return more_; }
  [[nodiscard]] const InputSelection& selection() const { return selection_; }
  [[nodiscard]] const Labels& labels() const { return labels_; }
  [[nodiscard]] std::size_t channels() const { return selection_.outputs(); }
  [[nodiscard]] std::size_t samples() const { return selection_.samples; }
  [[nodiscard]] const NoiseRecipe& noise() const { return options_.noise; }
  /// Returns the noise of test rows.
  [[nodiscard]] Noise judged() const { return {noise().level}; }
  /// Returns the noise of training rows in an epoch: that of test rows, unless training rows have random
  /// levels.
  [[nodiscard]] Noise training(std::uint64_t epoch) const {
    return noise().training ? Noise{{}, epoch} : judged();
  }
  /// Returns the noise of validation rows: the same in every epoch.
  [[nodiscard]] Noise validation() const { return training(kValidationDraw); }
  /// Returns whether the series are kept in memory. If the noise varies, complete records are kept instead.
  [[nodiscard]] bool in_memory() const { return !series_.empty(); }
  /// Reads the series of rows. rows: row numbers of the dataset, in any order; out: rows x values of the
  /// selection. Noise other than that of test rows is possible only with NoiseRecipe::training.
  void read(std::span<const std::uint64_t> rows, float* out, const Noise& noise) const;
  void read(std::span<const std::uint64_t> rows, float* out) const { read(rows, out, judged()); }

 private:
  void require_same(const mpi::store::Dataset& more) const;
  void append(mpi::store::Dataset more);
  void load(const mpi::store::ShardInfo& shard, bool fits);
  void take_all(const ShardSource& source, mpi::store::Dataset& into);
  void take(const mpi::store::ShardData& shard, mpi::store::Dataset& into);
  void require_rows() const;
  /// Returns the number of values kept per row in memory.
  [[nodiscard]] std::size_t kept() const;
  void keep_labels(const mpi::store::RowBlock& block, const mpi::store::ShardInfo& shard);
  void keep_series(const mpi::store::RowBlock& block, const mpi::store::ShardInfo& shard);
  /// Computes the series of a record with its noise. `row`: number of the record in the dataset.
  void series_of(const float* record, const mpi::store::ShardInfo& shard, std::uint64_t row,
                 const Noise& noise, float* out) const;
  /// Returns the fixed X'd of a row's machine [pu on the machine base].
  [[nodiscard]] double reactance(std::uint64_t row) const;
  /// Row to read, and its position in the output. read_run() copies such rows from a contiguous run.
  struct Wanted {
    std::uint64_t row;
    std::size_t slot;
  };
  void read_run(std::span<const Wanted> run, const Noise& noise, float* out) const;
  [[nodiscard]] const mpi::store::ShardInfo& shard_of(std::uint64_t row) const;
  void check_finite(const float* series, const mpi::store::ShardInfo& shard, std::uint64_t row) const;

  mpi::store::Dataset dataset_;
  std::optional<mpi::store::Dataset> more_;
  std::vector<mpi::store::ShardInfo> shards_;  ///< shards of both datasets, with consecutive row numbers
  std::size_t rows_ = 0;
  bool from_memory_ = false;
  InputSelection selection_;
  StreamOptions options_;
  RecordNoise noise_;
  Labels labels_;
  std::vector<float> series_;   ///< series of all rows, if the noise is fixed and they fit
  std::vector<float> records_;  ///< records of all rows, if the noise varies and they fit
};

/// Returns the order in which an epoch visits `rows` (ascending). Blocks of 256 neighbouring rows are
/// shuffled, then the rows within each window of 64 blocks. The order depends only on rows, seed and epoch.
/// Sets below 16,384 rows are shuffled completely.
std::vector<std::uint64_t> epoch_order(std::span<const std::uint64_t> rows, std::uint64_t seed,
                                       std::uint64_t epoch);

struct Batch {
  std::span<const std::uint64_t> rows;
  std::vector<float> series;  ///< rows x values of the selection
};

/// Reader of an epoch's batches; it reads one chunk ahead if the series are not in memory.
class BatchReader {
 public:
  /// Starts at batch `first`. `order`: rows in the order of reading; `batch`: rows per batch; `noise`:
  /// default is that of test rows.
  BatchReader(const ShardStream& stream, std::vector<std::uint64_t> order, std::size_t batch,
              std::size_t first = 0, const std::optional<Noise>& noise = {});
  /// Reads the next batch. Returns false at the end.
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
