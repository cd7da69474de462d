// Example: reader of a dataset of `swingbank generate`. Prints the mean of each parameter and the largest
// speed deviation of each shard.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "mpi/store/dataset.hpp"

int main(int argc, char** argv) try {
  namespace store = swingbank::mpi::store;
  if (argc != 2) return std::fprintf(stderr, "usage: read_dataset FOLDER\n"), 2;
  const store::Dataset dataset = store::open_dataset(argv[1]);
  const auto speed = std::ranges::find(dataset.channel_names, "speed") - dataset.channel_names.begin();
  for (const store::ShardInfo& info : dataset.shards) {
    const store::ShardData shard =
        store::read_checked(info);  // verifies the shard against the header and the journal
    std::printf("%s: %zu records\n", info.path.filename().c_str(), shard.rows);
    for (std::size_t p = 0; p < shard.parameter_count && shard.rows > 0; ++p) {
      double sum = 0;
      for (std::size_t row = 0; row < shard.rows; ++row)
        sum += shard.parameters[row * shard.parameter_count + p];
      std::printf("  mean %s = %.4f %s\n", dataset.parameter_names[p].c_str(),
                  sum / static_cast<double>(shard.rows), dataset.parameter_units[p].c_str());
    }
    double largest = 0;
    for (std::size_t row = 0; row < shard.rows; ++row)
      for (std::size_t k = 0; k < shard.samples; ++k)
        largest = std::max<double>(
            largest,
            std::abs(
                shard.records[(row * shard.channels + static_cast<std::size_t>(speed)) * shard.samples + k]));
    std::printf("  largest |speed| = %.5f pu\n", largest);
  }
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
