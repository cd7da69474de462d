#pragma once
// Measurement noise on a dataset's records, added as they are read: a pure function of seed, draw, row,
// channel and sample, so that any order of reading gives the same bytes. How much:
// sim/core/measurement_noise.hpp.
#include <cstdint>
#include <optional>
#include <vector>

#include "mpi/store/dataset.hpp"
#include "sim/core/frequency.hpp"
#include "sim/core/measurement_noise.hpp"

namespace swingbank::train::data {

/// Levels of rows that train: 0 for a share of them, logarithmically uniform for the others.
struct NoiseLevels {
  double low = 0, high = 0, share_at_zero = 0;
};

/// What a run reads its records with.
struct NoiseRecipe {
  double level = 0;  ///< 0: the records as they are
  std::uint64_t seed = 1;
  std::optional<NoiseLevels> training = {};  ///< where each row that trains draws a level of its own
};

/// Which noise a reading shows.
struct Noise {
  std::optional<double> level = {};  ///< of all rows; none: each row draws its own, from the recipe's levels
  std::uint64_t draw = 0;            ///< another draw is another noise, and another level where it is drawn
};

/// How a network is told the level; 0 stands a decade below 0.01 %.
float level_input(double level);
/// The opposite.
double level_of_input(float input);

class RecordNoise {
 public:
  /// Throws InputError with every channel of which nobody knows how it is measured.
  RecordNoise(const mpi::store::DatasetHeader& dataset, const NoiseRecipe& recipe);
  [[nodiscard]] bool none() const { return recipe_.level == 0; }
  [[nodiscard]] double level(std::uint64_t row, const Noise& noise) const;
  /// record: channels x samples of the dataset's row `row`. Without a level of its own, the row's noise is
  /// made of stretches of one long series, which costs a tenth.
  void add(std::uint64_t row, const Noise& noise, float* record) const;
  /// The recipe's level, draw 0.
  void add(std::uint64_t row, float* record) const { add(row, {recipe_.level}, record); }

 private:
  enum class Kind { phasor, frequency, field, speed };
  struct Noisy {
    Kind kind;
    std::uint32_t key;  ///< of the quantity, whatever its place in the record; frequency has theta's
  };
  void draw_new(std::uint64_t row, const Noisy& channel, std::uint64_t draw, double* out) const;
  void draw_from_store(std::uint64_t row, const Noisy& channel, std::uint64_t draw, double* out) const;
  void add_to(const Noisy& channel, double level, std::vector<double>& drawn, float* samples) const;

  NoiseRecipe recipe_;
  std::vector<float> store_;  ///< normal numbers; empty unless rows draw their levels
  std::vector<Noisy> channels_;
  std::size_t samples_ = 0;
  double rate_ = 0, system_frequency_ = 0;
  sim::FrequencyFilter filter_;
};

/// The constants of its channel "frequency".
sim::FrequencyFilter frequency_filter(const mpi::store::DatasetHeader& dataset);

}  // namespace swingbank::train::data
