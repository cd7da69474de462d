#pragma once
// Measurement noise that is added to a dataset's records while they are read. It is a pure function of seed,
// realisation, row, channel and sample, so that it does not depend on the order of reading.
// sim/core/measurement_noise.hpp defines the magnitudes.
#include <cstdint>
#include <optional>
#include <vector>

#include "mpi/store/dataset.hpp"
#include "sim/core/frequency.hpp"
#include "sim/core/measurement_noise.hpp"

namespace swingbank::train::data {

/// Distribution of the noise level of training rows: 0 for the fraction `share_at_zero` of the rows,
/// log-uniform in [low, high] for the other rows.
struct NoiseLevels {
  double low = 0, high = 0, share_at_zero = 0;
};

/// Noise of a run.
struct NoiseRecipe {
  double level = 0;  ///< level of all rows; with `training`, of the test rows only; 0: no noise
  std::uint64_t seed = 1;
  std::optional<NoiseLevels> training = {};  ///< if present, each training row has a random level
};

/// Noise realisation with which rows are read.
struct Noise {
  std::optional<double> level = {};  ///< of all rows; none: random per row, from NoiseRecipe::training
  std::uint64_t draw = 0;            ///< number of the realisation; also selects the random levels
};

/// Returns the network input that encodes a noise level: half the natural logarithm of (level + 1e-5) / 1e-3.
/// Level 0 is thus encoded as 0.001 %.
float level_input(double level);
/// Inverse of level_input().
double level_of_input(float input);

class RecordNoise {
 public:
  /// Throws InputError with every channel that has no noise model.
  RecordNoise(const mpi::store::DatasetHeader& dataset, const NoiseRecipe& recipe);
  [[nodiscard]] bool none() const { return recipe_.level == 0; }
  [[nodiscard]] double level(std::uint64_t row, const Noise& noise) const;
  /// Adds noise to a record, channels x samples of the dataset's row `row`. If each row has a random level,
  /// the noise consists of segments of one stored series; this takes a tenth of the time of new random
  /// numbers.
  void add(std::uint64_t row, const Noise& noise, float* record) const;
  /// Adds noise of the recipe's level, realisation 0.
  void add(std::uint64_t row, float* record) const { add(row, {recipe_.level}, record); }

 private:
  enum class Kind { phasor, frequency, field, speed };
  struct Noisy {
    Kind kind;
    std::uint32_t key;  ///< random key of the quantity; frequency has that of theta
  };
  void draw_new(std::uint64_t row, const Noisy& channel, std::uint64_t draw, double* out) const;
  void draw_from_store(std::uint64_t row, const Noisy& channel, std::uint64_t draw, double* out) const;
  void add_to(const Noisy& channel, double level, std::vector<double>& drawn, float* samples) const;

  NoiseRecipe recipe_;
  std::vector<float> store_;  ///< stored normal numbers; empty unless rows have random levels
  std::vector<Noisy> channels_;
  std::size_t samples_ = 0;
  double rate_ = 0, system_frequency_ = 0;
  sim::FrequencyFilter filter_;
};

/// Returns the filter constants of the dataset's channel "frequency".
sim::FrequencyFilter frequency_filter(const mpi::store::DatasetHeader& dataset);

}  // namespace swingbank::train::data
