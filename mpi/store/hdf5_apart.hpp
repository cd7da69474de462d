#pragma once
// What a process of its own read of an HDF5 file, on its way through a pipe.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace swingbank::mpi::store::h5 {

/// In that process: reads what is asked for and is there, and returns it as bytes. A name is that of an
/// array,
/// "/records", with the type to convert to before it if not its own, "f8/time"; or that of an attribute of
/// the root group with what it is: "text@format", "real@rate", "integer@seed". Throws InputError.
std::string read_asked(const std::filesystem::path& file, const std::vector<std::string>& names);

/// In the one that asked: those bytes.
class Contents {
 public:
  struct Array {
    std::string kind;  ///< "f4", "f8", "u8", "i4", "i2" or "u1": Type<T>::kKind
    std::vector<std::uint64_t> shape;
    std::string bytes;  ///< as many as kind and shape say
  };
  using Value = std::variant<Array, std::vector<std::string>, std::vector<double>, std::uint64_t>;
  /// Throws InputError naming `file` where a process gone astray wrote something else.
  static Contents parse(std::string_view bytes, const std::filesystem::path& file);

  /// What stands under the name ("/records", "@format"); null: nothing.
  [[nodiscard]] const Value* find(const std::string& name) const {
    const auto at = values_.find(name);
    return at == values_.end() ? nullptr : &at->second;
  }

 private:
  std::map<std::string, Value> values_;
};

}  // namespace swingbank::mpi::store::h5
