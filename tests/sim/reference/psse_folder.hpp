#pragma once
// Location of external records, including those of PSS/E. They are not part of this repository. The tests
// look in $SWINGBANK_REFERENCE, then in ../shared/reference.
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace swingbank::sim::test {

/// A folder of the records, e.g. "psse-test01". Throws std::runtime_error if it is not there.
inline std::filesystem::path record_folder(const std::string& name) {
  const char* given = std::getenv("SWINGBANK_REFERENCE");
  const auto root =
      given ? std::filesystem::path(given) : std::filesystem::path(SWINGBANK_SOURCE) / "../shared/reference";
  if (!std::filesystem::exists(root / name))
    throw std::runtime_error("no records at " + (root / name).string() +
                             " (they are not part of this repository): set SWINGBANK_REFERENCE to the "
                             "folder that holds " +
                             name + ", or run .ci/run --without-psse");
  return root / name;
}
/// Folder of one case of psse/, e.g. "SEXS".
inline std::filesystem::path psse_folder(const std::string& name) { return record_folder("psse/" + name); }

}  // namespace swingbank::sim::test
