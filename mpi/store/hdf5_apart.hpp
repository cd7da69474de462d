#pragma once
// Transfer of an HDF5 file's content from a reading process through a pipe, as bytes in CBOR.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace swingbank::mpi::store::h5 {

/// Reads a file in the reading process: returns the requested objects that exist, as bytes. A name denotes an
/// array ("/records"), or an array with the type to convert to ("f8/time"). It may also denote an attribute
/// of the root group, with its kind ("text@format", "real@rate", "integer@seed"). Throws InputError if the
/// file cannot be read.
std::string read_asked(const std::filesystem::path& file, const std::vector<std::string>& names);

/// Objects in the bytes of read_asked(), for the calling process.
class Contents {
 public:
  /// Array with its type.
  struct Array {
    std::string kind;                  ///< "f4", "f8", "u8", "i4", "i2" or "u1": Type<T>::kKind
    std::vector<std::uint64_t> shape;  ///< length of each dimension
    std::string bytes;                 ///< values; their length agrees with kind and shape
  };
  /// Content of an object: array, texts, real numbers or integer.
  using Value = std::variant<Array, std::vector<std::string>, std::vector<double>, std::uint64_t>;
  /// Parses the bytes. Throws InputError, which names `file`, if they are invalid.
  static Contents parse(std::string_view bytes, const std::filesystem::path& file);

  /// Returns the object with this name ("/records", "@format"), or null.
  [[nodiscard]] const Value* find(const std::string& name) const {
    const auto at = values_.find(name);
    return at == values_.end() ? nullptr : &at->second;
  }

 private:
  std::map<std::string, Value> values_;
};

}  // namespace swingbank::mpi::store::h5
