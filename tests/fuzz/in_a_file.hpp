#pragma once
// Bytes as files in a separate folder, for readers that need a path.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace swingbank::fuzz {

/// A folder in memory, the same for all inputs of this process.
inline const std::filesystem::path& folder() {
  struct Folder {
    std::filesystem::path path = "/dev/shm/swingbank-fuzz-" + std::to_string(::getpid());
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder own;
  return own.path;
}

inline std::filesystem::path in_a_file(std::string_view bytes, const std::string& name) {
  std::filesystem::path file = folder() / name;
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file;
}

}  // namespace swingbank::fuzz
