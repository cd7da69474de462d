#pragma once
// Files of one record, determined once from the name that the user gives.
#include <filesystem>
#include <string>
#include <vector>

namespace swingbank::validate::record {

/// One file of a record, with the selected terminal.
struct SourceFile {
  /// Format of the file, by its extension.
  enum class Format { text, comtrade, hdf5, matlab, pscad };
  Format format = Format::text;        ///< format of the file
  std::filesystem::path path;          ///< without the terminal
  std::filesystem::path config, data;  ///< .cfg and .dat of a COMTRADE pair, or .inf of PSCAD; else empty
  std::string name;                    ///< file name as given, without folder: "run.h5#G2"
  std::string terminal;                ///< "G2" of "run.h5#G2"; empty: none is selected
  /// Returns every file that is read.
  [[nodiscard]] std::vector<std::filesystem::path> all_files() const;
};

/// Location of a record: "FILE", "FILE#TERMINAL", or the files of one event, "FILE+FILE".
struct Source {
  /// Determines the files of a record. The conversion is implicit, because a path identifies a record.
  Source(const std::filesystem::path& named);
  /// The same, from a string.
  Source(const std::string& named) : Source(std::filesystem::path(named)) {}
  /// The same, from a literal.
  Source(const char* named) : Source(std::filesystem::path(named)) {}
  /// Returns whether `record` is the file name, with or without terminal.
  [[nodiscard]] bool is_named(const std::string& record) const;

  std::filesystem::path path;     ///< as given
  std::string name;               ///< name of the record without folders: "a.csv#NORTH", "a.csv+b.csv"
  std::vector<SourceFile> files;  ///< in the order given, at least one
};

/// Returns the path of PSCAD's output file `number`, from 1, beside its .inf: "case_01.out" of "case.inf".
std::filesystem::path pscad_part(const std::filesystem::path& inf, std::size_t number);

}  // namespace swingbank::validate::record
