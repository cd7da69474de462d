#include "train/checkpoint.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <cerrno>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "mpi/store/durable.hpp"
#include "sim/core/problem.hpp"

namespace swingbank {
namespace {
using nlohmann::json;
constexpr char kMagic[] = "swingbank-checkpoint-1\n";

struct Hash {
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state{XXH3_createState(), XXH3_freeState};
  Hash() { XXH3_64bits_reset(state.get()); }
  void add(const void* data, std::size_t bytes) { XXH3_64bits_update(state.get(), data, bytes); }
  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits_digest(state.get()); }
};

[[noreturn]] void raise_damaged(const std::filesystem::path& file, const std::string& why) {
  throw InputError({"checkpoint cannot be used", file.string(), why,
                    "remove the file to train this run from the beginning, or use another output folder"});
}
}  // namespace

void write_checkpoint(const std::filesystem::path& file, const json& header,
                      const std::vector<std::span<const float>>& arrays) {
  Hash hash;
  errno = 0;
  std::ofstream out(temporary_name(file), std::ios::binary | std::ios::trunc);
  const auto put = [&](const void* data, std::size_t bytes) {
    hash.add(data, bytes);
    out.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  };
  const auto put_size = [&](std::uint64_t n) { put(&n, sizeof n); };
  const std::string text = header.dump();
  put(kMagic, sizeof kMagic - 1);
  put_size(text.size());
  put(text.data(), text.size());
  put_size(arrays.size());
  for (const auto& a : arrays) {
    put_size(a.size());
    put(a.data(), a.size_bytes());
  }
  const std::uint64_t seal = hash.value();
  out.write(reinterpret_cast<const char*>(&seal), sizeof seal);
  out.close();
  if (!out) {
    const int error = errno;
    std::error_code ignored;
    std::filesystem::remove(temporary_name(file), ignored);
    raise_file_error(file, error, "checkpoint cannot be written");
  }
  publish(file);
}

bool read_checkpoint(const std::filesystem::path& file, const json& run, json& header,
                     const std::vector<std::span<float>>& arrays) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return false;
  Hash hash;
  const auto get = [&](void* data, std::size_t bytes) {
    if (!in.read(static_cast<char*>(data), static_cast<std::streamsize>(bytes)))
      raise_damaged(file, "it ends too early");
    hash.add(data, bytes);
  };
  const auto get_size = [&] {
    std::uint64_t n = 0;
    get(&n, sizeof n);
    return n;
  };
  std::string magic(sizeof kMagic - 1, '\0');
  get(magic.data(), magic.size());
  if (magic != kMagic) raise_damaged(file, "it is no swingbank checkpoint");
  const std::uint64_t length = get_size();
  if (length > (std::uint64_t{1} << 30)) raise_damaged(file, "its header is damaged");
  std::string text(length, '\0');
  get(text.data(), text.size());
  header = json::parse(text, nullptr, false);
  if (header.is_discarded()) raise_damaged(file, "its header is damaged");
  if (header.value("run", json()) != run)
    raise_damaged(file, "it belongs to a run with other settings or data");
  if (get_size() != arrays.size()) raise_damaged(file, "it holds another number of arrays");
  for (const auto& a : arrays) {
    if (get_size() != a.size()) raise_damaged(file, "an array has another length");
    get(a.data(), a.size_bytes());
  }
  const std::uint64_t expected = hash.value();
  std::uint64_t seal = 0;
  in.read(reinterpret_cast<char*>(&seal), sizeof seal);
  if (!in || seal != expected) raise_damaged(file, "its checksum is wrong");
  return true;
}

}  // namespace swingbank
