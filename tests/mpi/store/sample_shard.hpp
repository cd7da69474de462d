#pragma once
// A small shard with recognisable contents, and a temporary folder.
#include <unistd.h>

#include <filesystem>
#include <string>

#include "mpi/store/shard.hpp"

namespace swingbank::test {

struct Folder {
  std::filesystem::path path;
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "swingbank-test-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

/// Row i of channel c at sample k is 1000 (first + i) + 10 c + 0.25 k: exact in float.
inline mpi::store::ShardData sample_shard(std::uint64_t rows = 5, std::uint64_t first = 0,
                                          std::uint64_t shard = 0) {
  mpi::store::ShardData d;
  d.attributes = {"0123456789abcdef", "dp54 lanes=8", "swingbank test", 7,          shard,       120.0,
                  "GENCLS",           {"P", "theta"}, {"pu", "rad"},    {"H", "D"}, {"s", "pu"}, {1.0, 1.0},
                  {10.0, 8.0}};
  d.rows = rows;
  d.channels = 2;
  d.samples = 9;
  d.parameter_count = 2;
  for (std::uint64_t i = first; i < first + rows; ++i) {
    for (int c = 0; c < 2; ++c)
      for (int k = 0; k < 9; ++k)
        d.records.push_back(static_cast<float>(1000.0 * static_cast<double>(i) + 10 * c + 0.25 * k));
    d.parameters.insert(d.parameters.end(), {1.0 + static_cast<double>(i), 2.0});
    d.sample_id.push_back(i);
    d.generator.push_back(static_cast<std::int32_t>(30 + i % 10));
    d.fault.insert(d.fault.end(), {4.0, 2.0, 2.1, 0.0, 0.0});
    d.largest_spread.push_back(0.5);
    d.angle_valid.insert(d.angle_valid.end(), 9, 1);
    d.draw_sample_id.push_back(i);
    d.draw_outcome.push_back(0);
  }
  return d;
}

}  // namespace swingbank::test
