#pragma once
// card.json: all that is needed to make a dataset again, whatever has become of the files it was made from:
// the config, the files it names, what the command line replaced, and what made it.
#include <map>

#include "mpi/draw/dataset_config.hpp"

namespace swingbank::mpi::draw {

struct CardFile {
  std::string name;  ///< below the folder of the config, as the card's config names it
  std::string text;
};

struct Card {
  std::string name;    ///< of the config's file
  std::string config;  ///< its text, with names of files as below
  std::vector<CardFile> files;
  Overrides overrides;
  std::string config_hash, kernel;             ///< as in dataset.json
  std::map<std::string, std::string> made_by;  ///< software, compiler, MPI, HDF5, host, processor: by name
};

/// Replaces a name of a file wherever it stands between quotes. False if it stands nowhere so.
bool replace_name(std::string& text, const std::string& from, const std::string& to);
/// Throws InputError if a file cannot be read, or if the config names one in a way that this cannot replace.
Card card_of(const DatasetConfig& config, const std::string& kernel,
             const std::map<std::string, std::string>& made_by);
/// Writes card.json into the folder.
void write_card(const std::filesystem::path& folder, const Card& card);
/// `where`: the file, or a dataset's folder. Throws InputError if it is no card or a byte of it has changed.
Card read_card(const std::filesystem::path& where);
/// Writes the card's files into `folder` and returns the config's place.
std::filesystem::path unpack(const Card& card, const std::filesystem::path& folder);

}  // namespace swingbank::mpi::draw
