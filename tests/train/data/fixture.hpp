#pragma once
// Small synthetic datasets for the tests of train/, written by the shard writer into a separate folder.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <string>

#include "base/durable.hpp"
#include "mpi/store/dataset.hpp"
#include "mpi/store/journal.hpp"
#include "train/data/shard_stream.hpp"

namespace swingbank::test {

struct Folder {
  std::filesystem::path path;
  explicit Folder(const std::string& name)
      : path(std::filesystem::temp_directory_path() /
             ("swingbank-train-" + name + "-" + std::to_string(getpid()))) {
    std::filesystem::remove_all(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

struct Plan {
  std::size_t rows = 400, rows_per_shard = 150, samples = 40;
  double rate = 20.0;
  int rows_per_point = 1;                ///< number of consecutive rows with the same parameters
  std::optional<std::size_t> spoil_row;  ///< gets a value that is not a number
  int shift_generator = 0;               ///< generator whose records are shifted by 100; 0: none
  bool electrical = false;               ///< also Q and V, and an event after a quarter of the samples
  std::uint64_t seed = 11;
};

/// Channels "P" and "speed": a damped swing whose frequency and decay follow from H and D (uniform 1-10 and
/// 1-8), with an uninformative amplitude and level. X is a constant parameter. Row i belongs to
/// generator 30 + i % 10.
inline mpi::store::Dataset make_dataset(const std::filesystem::path& folder, const Plan& plan = {}) {
  make_folder(folder / "shards");
  mpi::store::DatasetHeader header;
  header.config_hash = "0123456789abcdef";
  header.kernel = "test";
  header.software = "test";
  header.machine_model = "TEST";
  header.config = plan.electrical ? "fault.start = " +
                                        std::to_string(0.25 * static_cast<double>(plan.samples) / plan.rate)
                                  : "made up";
  header.seed = 7;
  header.draws = plan.rows;
  header.draws_per_shard = plan.rows_per_shard;
  header.rate = plan.rate;
  header.samples = plan.samples;
  header.channel_names = {"P", "speed"};
  if (plan.electrical) header.channel_names.insert(header.channel_names.end(), {"Q", "V"});
  header.channel_units.assign(header.channel_names.size(), "pu");
  header.parameter_names = {"H", "D", "X"};
  header.parameter_units = {"s", "pu", "pu"};
  header.parameter_low = {1.0, 1.0, 0.3};
  header.parameter_high = {10.0, 8.0, 0.3};
  mpi::store::write_header(folder, header);
  mpi::store::Journal journal(folder / "journal.jsonl");
  std::mt19937_64 random(plan.seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  double h = 0.0, d = 0.0;
  for (std::size_t first = 0, number = 0; first < plan.rows; first += plan.rows_per_shard, ++number) {
    mpi::store::ShardData shard;
    shard.rows = std::min(plan.rows_per_shard, plan.rows - first);
    shard.channels = header.channel_names.size();
    shard.samples = plan.samples;
    shard.parameter_count = 3;
    for (std::size_t r = 0; r < shard.rows; ++r) {
      const std::size_t row = first + r;
      if (row % static_cast<std::size_t>(plan.rows_per_point) == 0) {
        h = uniform(1.0, 10.0);
        d = uniform(1.0, 8.0);
      }
      const double level = uniform(0.5, 1.0), swing = uniform(0.8, 1.2);
      const double shift = plan.shift_generator == static_cast<int>(30 + row % 10) ? 100.0 : 0.0;
      for (int c = 0; c < 2; ++c)
        for (std::size_t k = 0; k < plan.samples; ++k) {
          const double t = static_cast<double>(k) / plan.rate, wave = swing * std::exp(-0.2 * d * t);
          shard.records.push_back(
              static_cast<float>(c == 0 ? shift + level + wave * std::sin(12.0 / std::sqrt(h) * t)
                                        : shift + 0.01 * wave * std::cos(12.0 / std::sqrt(h) * t)));
        }
      for (std::size_t c = 2; c < shard.channels; ++c)
        for (std::size_t k = 0; k < plan.samples; ++k) {
          const double t = static_cast<double>(k) / plan.rate, wave = 0.1 * swing * std::exp(-0.2 * d * t);
          shard.records.push_back(
              static_cast<float>((c == 2 ? 0.2 : 1.0) + wave * std::sin(12.0 / std::sqrt(h) * t + 1.0)));
        }
      if (plan.spoil_row == row) shard.records.back() = std::nanf("");
      shard.parameters.insert(shard.parameters.end(), {h, d, 0.3});
      shard.sample_id.push_back(row);
      shard.generator.push_back(static_cast<std::int32_t>(30 + row % 10));
      shard.fault.insert(shard.fault.end(), {16.0, 2.0, 2.1, 0.0, 0.0});
      shard.largest_spread.push_back(1.0);
      shard.draw_sample_id.push_back(row);
      shard.draw_outcome.push_back(0);
    }
    auto& a = shard.attributes;
    a.config_hash = header.config_hash;
    a.kernel = header.kernel;
    a.software = header.software;
    a.seed = header.seed;
    a.shard = number;
    a.rate = header.rate;
    a.machine_model = header.machine_model;
    a.channel_names = header.channel_names;
    a.channel_units = header.channel_units;
    a.parameter_names = header.parameter_names;
    a.parameter_units = header.parameter_units;
    a.parameter_low = header.parameter_low;
    a.parameter_high = header.parameter_high;
    const std::string name = "shards/shard-" + std::to_string(number) + ".h5";
    mpi::store::write_shard(folder / name, shard);
    const mpi::store::JournalLine line[] = {{number,
                                             name,
                                             shard.rows,
                                             shard.rows,
                                             std::filesystem::file_size(folder / name),
                                             hex(mpi::store::shard_hash(shard)),
                                             hash_of_file(folder / name),
                                             {{"stable", shard.rows}}}};
    journal.append(line);
  }
  return mpi::store::open_dataset(folder);
}

inline train::data::InputRecipe whole_record(const Plan& plan = {}) {
  return {{"P", "speed"},
          0.0,
          static_cast<double>(plan.samples) / plan.rate,
          1,
          train::data::InputForm::absolute};
}

inline std::vector<std::uint64_t> all_rows(std::size_t count) {
  std::vector<std::uint64_t> rows(count);
  for (std::size_t i = 0; i < count; ++i) rows[i] = i;
  return rows;
}

}  // namespace swingbank::test
