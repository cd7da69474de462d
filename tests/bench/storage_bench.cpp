// Speed of the storage: shards against plain writes of the same bytes, alternating in one run.
//   bench_storage FOLDER MEGABYTES ROUNDS
// Prints medians and, for each kind of shard, the ratio of the median times; 1 is as fast as a plain write.
// "As generate": written by the function that `generate` uses, with the hashes of rows and file.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/durable.hpp"
#include "mpi/ranks/session.hpp"
#include "mpi/ranks/shard_group.hpp"
#include "mpi/store/index.hpp"
#include "mpi/store/manifest.hpp"
#include "mpi/store/quantise.hpp"
#include "mpi/store/shard.hpp"
#include "mpi/store/shard_name.hpp"
#include "mpi/store/virtual_dataset.hpp"

namespace {
using namespace swingbank;
using namespace swingbank::mpi;
namespace fs = std::filesystem;

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Rows of the same size as for the 39-bus grid: six channels, 15 s at 120/s.
store::ShardData rows_of(double megabytes, bool int16) {
  store::ShardData d;
  d.channels = 6;
  d.samples = 1800;
  d.parameter_count = 14;
  d.rows = std::max<std::size_t>(1, static_cast<std::size_t>(megabytes * 1e6 / (6 * 1800 * (int16 ? 2 : 4))));
  store::ShardAttributes& a = d.attributes;
  a = {"0123456789abcdef",
       "kernel",
       "swingbank bench",
       1,
       0,
       120.0,
       "GENROU",
       {"P", "Q", "V", "Efd", "Ifd", "speed"},
       std::vector<std::string>(6, "pu"),
       {},
       {},
       {},
       {}};
  for (std::size_t p = 0; p < d.parameter_count; ++p) {
    a.parameter_names.push_back(fmt::format("p{}", p));
    a.parameter_units.emplace_back("pu");
    a.parameter_low.push_back(0.0);
    a.parameter_high.push_back(1.0);
  }
  for (std::size_t i = 0; i < d.rows; ++i) {
    for (std::size_t k = 0; k < d.channels * d.samples; ++k)
      d.records.push_back(static_cast<float>(1.0 + 0.1 * std::sin(0.01 * static_cast<double>(k + 7 * i))));
    d.parameters.insert(d.parameters.end(), d.parameter_count, 0.5);
    d.sample_id.push_back(i);
    d.generator.push_back(30);
    d.fault.insert(d.fault.end(), {4.0, 2.0, 2.1, 0.0, 0.0});
    d.largest_spread.push_back(1.0);
    d.draw_sample_id.push_back(i);
    d.draw_outcome.push_back(0);
  }
  a.int16 = int16;
  if (int16) store::quantise(d);
  return d;
}

/// Plain write and flush, without further guarantees.
void write_plainly(const fs::path& file, const std::vector<char>& bytes) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  for (std::size_t at = 0; fd >= 0 && at < bytes.size();) {
    const ssize_t n = ::write(fd, bytes.data() + at, std::min<std::size_t>(bytes.size() - at, 1 << 20));
    if (n <= 0) throw std::runtime_error("write");
    at += static_cast<std::size_t>(n);
  }
  if (fd < 0 || ::fsync(fd) != 0) throw std::runtime_error("fsync");
  ::close(fd);
}

double median(std::vector<double> v) {
  std::ranges::sort(v);
  return v[v.size() / 2];
}

void measure(const fs::path& folder, double megabytes, int rounds, bool int16) {
  const store::ShardData d = rows_of(megabytes, int16);
  const fs::path shard = folder / "shard.h5", plain = folder / "plain";
  store::write_shard(shard, d);
  const std::string content = read_text(shard);
  const std::vector<char> bytes(content.begin(), content.end());
  write_plainly(plain, bytes);
  std::vector<double> of_shard, of_plain, of_all;
  for (int i = 0; i < rounds; ++i) {
    fs::remove(plain);
    of_plain.push_back(seconds_of([&] { write_plainly(plain, bytes); }));
    fs::remove(shard);
    of_shard.push_back(seconds_of([&] { store::write_shard(shard, d); }));
    fs::remove(shard);
    of_all.push_back(seconds_of([&] { (void)ranks::write_shard(shard, d, MPI_COMM_SELF); }));
  }
  const double mb = static_cast<double>(bytes.size()) * 1e-6;
  fmt::print("{:8} {:7.1f} MB  plain {:6.0f} MB/s  shard {:6.0f} MB/s  ratio {:.3f}  as generate {:.3f}\n",
             int16 ? "int16" : "float32", mb, mb / median(of_plain), mb / median(of_shard),
             median(of_plain) / median(of_shard), median(of_plain) / median(of_all));
}

/// Time to open a dataset of the given number of shards; the shards do not exist, only names are read.
void measure_opening(const fs::path& folder, std::uint64_t shards) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  store::DatasetHeader h;
  h.config_hash = "0123456789abcdef";
  h.draws = 512 * shards;
  h.draws_per_shard = 512;
  store::write_header(folder, h);
  std::vector<store::JournalLine> lines;
  for (std::uint64_t s = 0; s < shards; ++s)
    lines.push_back({s,
                     store::shard_file_name(s, shards),
                     512,
                     500,
                     22000000,
                     hex(s * 0x9E3779B97F4A7C15),
                     hex(s),
                     {{"lost_synchronism", 12}, {"stable", 500}}});
  store::Journal(folder / "journal.jsonl").append(lines);
  const double by_journal = seconds_of([&] { (void)store::read_journals(folder); });
  store::write_manifest(folder, lines);
  std::size_t found = 0;
  const double by_manifest = seconds_of([&] { found = store::open_dataset(folder).shards.size(); });
  if (found != shards) throw std::runtime_error("another number of shards");
  fmt::print("{:9} shards: opened by the manifest in {:6.3f} s, journals alone {:6.2f} s\n", shards,
             by_manifest, by_journal);
  fs::remove_all(folder);
}
}  // namespace

int main(int argc, char** argv) {
  ranks::MpiSession session(&argc, &argv);
  if (argc != 4) {
    fmt::print(stderr, "usage: bench_storage FOLDER MEGABYTES ROUNDS\n");
    return 1;
  }
  const fs::path folder = argv[1];
  fs::create_directories(folder);
  for (const bool int16 : {false, true}) measure(folder, std::atof(argv[2]), std::atoi(argv[3]), int16);
  for (const std::uint64_t shards : {1000ULL, 20000ULL, 200000ULL}) measure_opening(folder / "many", shards);
}
