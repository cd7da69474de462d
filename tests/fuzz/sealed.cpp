// Checkpoints and saved networks: bytes after the magic number of a checksummed file, with a valid checksum
// -> header and arrays.
#include <xxhash.h>

#include "base/json.hpp"
#include "base/sealed_file.hpp"
#include "tests/fuzz/check.hpp"
#include "tests/fuzz/in_a_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace swingbank;
  fuzz::quiet();
  const SealedKind kind{"the file", "fuzzed01", "make it again"};
  std::string bytes = kind.magic + std::string(reinterpret_cast<const char*>(data), size);
  const std::uint64_t sum = XXH3_64bits(bytes.data(), bytes.size());
  bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  const auto file = fuzz::in_a_file(bytes, "f.sealed");
  std::vector<std::vector<float>> arrays;
  nlohmann::json header;
  const auto start = [&](const nlohmann::json& h, std::size_t count) {
    header = h;
    if (count > size) throw Unusable{"its number of arrays differs"};
    arrays.resize(count);
  };
  const auto place = [&](std::size_t i, std::size_t n) -> std::span<float> {
    arrays.at(i).resize(n);
    return arrays[i];
  };
  if (!fuzz::accepted([&] { fuzz::require(read_sealed(kind, file, start, place), "the file is there"); }))
    return 0;
  std::vector<std::span<const float>> same(arrays.begin(), arrays.end());
  fuzz::accepted([&] { write_sealed(kind, fuzz::folder() / "again", header, same); });
  return 0;
}
