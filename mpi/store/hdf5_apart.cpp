#include "mpi/store/hdf5_apart.hpp"

#include <optional>

#include "base/json.hpp"
#include "base/problem.hpp"
#include "mpi/store/hdf5_file.hpp"

namespace swingbank::mpi::store::h5 {
namespace {

using nlohmann::json;

template <class T>
json array_of(const File& file, const std::string& object) {
  std::vector<T> values;
  file.read(object, values);
  const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
  return {{"kind", Type<T>::kKind},
          {"shape", file.shape(object)},
          {"bytes", json::binary({first, first + values.size() * sizeof(T)})}};
}

json array_of(const File& file, const std::string& object, const std::string& kind) {
  if (kind == "f4") return array_of<float>(file, object);
  if (kind == "f8") return array_of<double>(file, object);
  if (kind == "u8") return array_of<std::uint64_t>(file, object);
  if (kind == "i4") return array_of<std::int32_t>(file, object);
  if (kind == "i2") return array_of<std::int16_t>(file, object);
  if (kind == "u1") return array_of<std::uint8_t>(file, object);
  file.fail_for("a shard has no array of type " + kind, "an array of another type", object);
}

json attribute_of(const File& file, const std::string& name, const std::string& kind) {
  if (kind == "text") return {{"texts", file.texts_attribute(name)}};
  if (kind == "real") return {{"reals", file.reals_attribute(name)}};
  return {{"integer", file.integer_attribute(name)}};
}

std::optional<std::size_t> width(const std::string& kind) {
  for (const char* known : {"f4", "f8", "u8", "i4", "i2", "u1"})
    if (kind == known) return static_cast<std::size_t>(kind[1] - '0');
  return std::nullopt;
}

/// Returns whether the length of an array's bytes agrees with its kind and shape.
bool fits(const Contents::Array& a) {
  const auto bytes = width(a.kind);
  if (!bytes) return false;
  std::uint64_t n = *bytes;
  for (const auto side : a.shape)
    if (__builtin_mul_overflow(n, side, &n)) return false;
  return n == (a.shape.empty() ? 0 : a.bytes.size());
}

Contents::Value value_of(const json& j) {
  if (j.contains("texts")) return j["texts"].get<std::vector<std::string>>();
  if (j.contains("reals")) return j["reals"].get<std::vector<double>>();
  if (j.contains("integer")) return j["integer"].get<std::uint64_t>();
  const auto& bytes = j.at("bytes").get_binary();
  return Contents::Array{
      j.at("kind"), j.at("shape"), {reinterpret_cast<const char*>(bytes.data()), bytes.size()}};
}

}  // namespace

std::string read_asked(const std::filesystem::path& path, const std::vector<std::string>& names) {
  const std::lock_guard guard(lock());
  const File file = File::open(path);
  json all = json::object();
  for (const std::string& asked : names) {
    const auto at = asked.find_first_of("/@");
    const std::string kind = asked.substr(0, at), name = asked.substr(at);
    if (name[0] == '/' && file.has(name)) {
      all[name] = array_of(file, name, kind.empty() ? file.kind(name) : kind);
    } else if (name[0] == '@' && file.has_attribute(name.substr(1))) {
      all[name] = attribute_of(file, name.substr(1), kind);
    }
  }
  std::string bytes;
  json::to_cbor(all, bytes);
  return bytes;
}

Contents Contents::parse(std::string_view bytes, const std::filesystem::path& file) {
  const auto astray = [&](const std::string& why) {
    throw InputError({"cannot read the file", file.string(),
                      "the reply of the reading process is invalid: " + why,
                      "copy the file again from its source, or generate it again"});
  };
  Contents contents;
  try {
    const json all = json::from_cbor(bytes);
    if (!all.is_object()) astray("it is no list of arrays and attributes");
    for (const auto& [name, value] : all.items()) contents.values_.emplace(name, value_of(value));
  } catch (const json::exception& e) {
    astray(e.what());
  }
  for (const auto& [name, value] : contents.values_)
    if (const auto* a = std::get_if<Array>(&value); a != nullptr && !fits(*a))
      astray(name + " has another number of bytes than its shape");
  return contents;
}

}  // namespace swingbank::mpi::store::h5
