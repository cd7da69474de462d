#pragma once
// Content of an HDF5 file that a separate process has read, as bytes for a pipe (CBOR).
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace swingbank::mpi::store::h5 {

/// Reader's side: returns the requested objects that exist, as bytes. A name denotes an array, "/records",
/// optionally with a type for conversion, "f8/time"; or an attribute of the root group with its kind,
/// "text@format", "real@rate", "integer@seed". Throws InputError if the file cannot be read.
std::string read_asked(const std::filesystem::path& file, const std::vector<std::string>& names);

/// Caller's side: the objects in these bytes.
class Contents {
 public:
  /// An array with its type.
  struct Array {
    std::string kind;                  ///< "f4", "f8", "u8", "i4", "i2" or "u1": Type<T>::kKind
    std::vector<std::uint64_t> shape;  ///< length of each dimension
    std::string bytes;                 ///< values; their length agrees with kind and shape
  };
  /// Content of an object: array, texts, real numbers or integer.
  using Value = std::variant<Array, std::vector<std::string>, std::vector<double>, std::uint64_t>;
  /// Parses the bytes. Throws InputError with `file` if they are invalid because the reader failed.
  static Contents parse(std::string_view bytes, const std::filesystem::path& file);

  /// Returns the object of a name ("/records", "@format"), or null.
  [[nodiscard]] const Value* find(const std::string& name) const {
    const auto at = values_.find(name);
    return at == values_.end() ? nullptr : &at->second;
  }

 private:
  std::map<std::string, Value> values_;
};

}  // namespace swingbank::mpi::store::h5
