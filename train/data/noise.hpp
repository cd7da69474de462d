#pragma once
// Measurement noise on a dataset's records, added as they are read: a pure function of seed, row, channel and
// sample, so that any order of reading gives the same bytes. How much: sim/core/measurement_noise.hpp.
#include <cstdint>
#include <vector>

#include "mpi/store/dataset.hpp"
#include "sim/core/frequency.hpp"
#include "sim/core/measurement_noise.hpp"

namespace swingbank::train::data {

/// What a run reads its records with.
struct NoiseRecipe {
  double level = 0;  ///< 0: the records as they are
  std::uint64_t seed = 1;
};

class RecordNoise {
 public:
  /// Throws InputError with every channel of which nobody knows how it is measured.
  RecordNoise(const mpi::store::DatasetHeader& dataset, const NoiseRecipe& recipe);
  [[nodiscard]] bool none() const { return recipe_.level == 0; }
  /// record: channels x samples of the dataset's row `row`.
  void add(std::uint64_t row, float* record) const;

 private:
  enum class Kind { phasor, frequency, field, speed };
  struct Noisy {
    Kind kind;
    std::uint32_t key;  ///< of the quantity, whatever its place in the record; frequency has theta's
  };
  void add_to(std::uint64_t row, const Noisy& channel, float* samples) const;

  NoiseRecipe recipe_;
  sim::MeasurementNoise noise_;
  std::vector<Noisy> channels_;
  std::size_t samples_ = 0;
  double rate_ = 0, system_frequency_ = 0;
  sim::FrequencyFilter filter_;
};

/// The constants of its channel "frequency".
sim::FrequencyFilter frequency_filter(const mpi::store::DatasetHeader& dataset);

}  // namespace swingbank::train::data
