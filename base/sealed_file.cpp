#include "base/sealed_file.hpp"

#include <xxhash.h>

#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/durable.hpp"
#include "base/problem.hpp"

namespace swingbank {
namespace {
using nlohmann::json;

struct Hash {
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state{XXH3_createState(), XXH3_freeState};
  Hash() { XXH3_64bits_reset(state.get()); }
  void add(const void* data, std::size_t bytes) { XXH3_64bits_update(state.get(), data, bytes); }
  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits_digest(state.get()); }
};

/// The file from its magic bytes to its checksum; throws Unusable where it is damaged.
void read_all(std::ifstream& in, std::uint64_t length, const SealedKind& kind,
              const std::function<void(const json&, std::size_t)>& start, const PlaceArray& place) {
  Hash hash;
  const auto get = [&](void* data, std::size_t bytes) {
    if (!in.read(static_cast<char*>(data), static_cast<std::streamsize>(bytes)))
      throw Unusable{"it ends too early"};
    hash.add(data, bytes);
  };
  const auto get_size = [&] {
    std::uint64_t n = 0;
    get(&n, sizeof n);
    return n;
  };
  std::string magic(std::strlen(kind.magic), '\0');
  get(magic.data(), magic.size());
  if (magic != kind.magic) throw Unusable{"it is no " + std::string(kind.what)};
  const std::uint64_t header_length = get_size();
  if (header_length > length) throw Unusable{"its header is damaged"};
  std::string text(header_length, '\0');
  get(text.data(), text.size());
  const json header = json::parse(text, nullptr, false);
  if (!header.is_object()) throw Unusable{"its header is damaged"};
  const std::uint64_t arrays = get_size();
  start(header, arrays);
  for (std::size_t i = 0; i < arrays; ++i) {
    const std::uint64_t size = get_size();
    if (size > length / sizeof(float)) throw Unusable{"it ends too early"};
    const std::span<float> to = place(i, size);
    get(to.data(), to.size_bytes());
  }
  const std::uint64_t expected = hash.value();
  std::uint64_t seal = 0;
  in.read(reinterpret_cast<char*>(&seal), sizeof seal);
  if (!in || seal != expected) throw Unusable{"its checksum is wrong"};
}
}  // namespace

void write_sealed(const SealedKind& kind, const std::filesystem::path& file, const json& header,
                  const std::vector<std::span<const float>>& arrays) {
  Hash hash;
  NewFile out(file, std::string(kind.what) + " cannot be written");
  const auto put = [&](const void* data, std::size_t bytes) {
    hash.add(data, bytes);
    out.write(data, bytes);
  };
  const auto put_size = [&](std::uint64_t n) { put(&n, sizeof n); };
  const std::string text = header.dump();
  put(kind.magic, std::strlen(kind.magic));
  put_size(text.size());
  put(text.data(), text.size());
  put_size(arrays.size());
  for (const auto& a : arrays) {
    put_size(a.size());
    put(a.data(), a.size_bytes());
  }
  const std::uint64_t seal = hash.value();
  out.write(&seal, sizeof seal);
  out.publish();
}

bool read_sealed(const SealedKind& kind, const std::filesystem::path& file,
                 const std::function<void(const json&, std::size_t)>& start, const PlaceArray& place) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return false;
  std::error_code unknown;
  const std::uint64_t length = std::filesystem::file_size(file, unknown);
  try {
    if (unknown) throw Unusable{unknown.message()};
    read_all(in, length, kind, start, place);
  } catch (const Unusable& e) {
    throw InputError({std::string(kind.what) + " cannot be used", file.string(), e.why, kind.remedy});
  }
  return true;
}

}  // namespace swingbank
