#include "base/write_file.hpp"

#include "base/durable.hpp"

namespace swingbank {

void write_file(const std::filesystem::path& file, std::string_view content) {
  if (file.has_parent_path()) make_folder(file.parent_path());
  write_text(file, content);
}

}  // namespace swingbank
