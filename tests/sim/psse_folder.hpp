#pragma once
// Where PSS/E's own records lie. They belong to others and are not in this repository: they are looked for in
// $SWINGBANK_REFERENCE/psse, then in ../shared/reference/psse.
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace swingbank::sim::test {

/// Folder of one case, e.g. "SEXS". Throws std::runtime_error if it is not there.
inline std::filesystem::path psse_folder(const std::string& name) {
  const char* given = std::getenv("SWINGBANK_REFERENCE");
  const auto root =
      given ? std::filesystem::path(given) : std::filesystem::path(SWINGBANK_SOURCE) / "../shared/reference";
  if (!std::filesystem::exists(root / "psse" / name))
    throw std::runtime_error("no PSS/E records at " + (root / "psse" / name).string() +
                             " (they are not part of this repository): set SWINGBANK_REFERENCE to the "
                             "folder that holds psse/, or run .ci/run --without-psse");
  return root / "psse" / name;
}

}  // namespace swingbank::sim::test
