// Shards: bytes as a file whose checksum is in the journal, as after a defective writer -> consistent rows.
#include "mpi/store/shard_apart.hpp"
#include "tests/fuzz/check.hpp"
#include "tests/fuzz/in_a_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  ::setenv("SWINGBANK_READER_SECONDS", "2", 1);  // a damaged file may cause an endless loop in its reader
  const auto file = fuzz::in_a_file({reinterpret_cast<const char*>(data), size}, "s.h5");
  mpi::store::ShardData shard;
  if (!fuzz::accepted([&] { shard = mpi::store::read_shard_apart(file); })) return 0;
  fuzz::require(shard.records.size() == shard.rows * shard.channels * shard.samples,
                "records fit their rows");
  fuzz::require(shard.parameters.size() == shard.rows * shard.parameter_count, "parameters fit their rows");
  fuzz::require(mpi::store::row_hashes(shard).size() == shard.rows, "each row has a hash");
  mpi::store::shard_hash(shard);
  fuzz::accepted([&] { mpi::store::count_outcomes(shard.draw_outcome, file); });
  return 0;
}
