#pragma once
// Protection of input files: no output of a command may replace one of its inputs. Readers of user files
// register each file. Commands check their outputs before the work, and durable.hpp repeats the check before
// each rename.
#include <filesystem>
#include <string>
#include <vector>

namespace swingbank {

/// Clears the list of inputs and switches the protection on or off. It is off by default: a process other
/// than a command may overwrite files that it has read.
void keep_inputs(bool on = true);
/// Registers an input file that was read. The path may be relative or a link; `require_inputs_kept` resolves
/// it.
void note_input(const std::filesystem::path& file);

/// File that the command is going to write or to remove.
struct Output {
  std::filesystem::path file;  ///< path of the file
  std::string where;           ///< the option that names it or its folder
};
/// Throws InputError if an output is the same file as an input or as another output. Recognises links, hard
/// links and other spellings of the path. Does nothing while the protection is off.
void require_inputs_kept(const std::vector<Output>& outputs);

}  // namespace swingbank
