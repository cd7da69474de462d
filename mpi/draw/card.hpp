#pragma once
// Dataset card (card.json): copies of the config and of the files that it names, the command-line overrides,
// and the names of software and machine. With it, a dataset can be generated again without its input files.
#include <map>

#include "mpi/draw/dataset_config.hpp"

namespace swingbank::mpi::draw {

/// Copy of an input file.
struct CardFile {
  std::string name;  ///< path relative to the config's folder, as in the card's config
  std::string text;
};

/// Content of card.json.
struct Card {
  std::string name;    ///< name of the config's file
  std::string config;  ///< text of the config, with the file names of `files`
  std::vector<CardFile> files;
  Overrides overrides;
  std::string config_hash, kernel;  ///< as in dataset.json
  /// By name: software, compiler, mpi, hdf5, host, processor, system (operating system).
  std::map<std::string, std::string> made_by;
};

/// Replaces every occurrence of the file name `from` in quotes by `to`. Returns false if there is none.
bool replace_name(std::string& text, const std::string& from, const std::string& to);
/// Returns the card of a config. Throws InputError if a named file cannot be read. A file name with escape
/// sequences is also an error, because `replace_name` does not find it.
Card card_of(const DatasetConfig& config, const std::string& kernel,
             const std::map<std::string, std::string>& made_by);
/// Writes card.json into the folder.
void write_card(const std::filesystem::path& folder, const Card& card);
/// Reads a card. `where`: the file, or a dataset's folder. Throws InputError if it is not a card or its
/// checksum is wrong.
Card read_card(const std::filesystem::path& where);
/// Writes the card's files into `folder` and returns the path of the config.
std::filesystem::path unpack(const Card& card, const std::filesystem::path& folder);

}  // namespace swingbank::mpi::draw
