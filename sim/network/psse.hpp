#pragma once
// PSS/E .raw (versions 32 and 33) and .dyr files.
#include <filesystem>
#include <string>
#include <vector>

#include "sim/network/network.hpp"

namespace swingbank::sim {

/// Reads a .raw file. Throws InputError with every fault of the file, each with its line number.
Network read_raw(const std::filesystem::path& file);
/// Writes version 33; reading it back gives the same values to the last bit.
void write_raw(const Network& network, const std::filesystem::path& file);

/// One record of a .dyr file, model parameters as they stand there.
struct DyrRecord {
  int bus;  ///< bus number
  std::string model, id;
  std::vector<double> values;
  int line;  ///< where it starts
};
/// Reads a .dyr file: records end with '/', may span lines. Throws InputError with every fault, with line numbers.
std::vector<DyrRecord> read_dyr(const std::filesystem::path& file);

}  // namespace swingbank::sim
