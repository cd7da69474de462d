#pragma once
// The check that no output of a command replaces one of its inputs. Whatever reads a file for the user notes
// it; commands check their outputs before the work, and durable.hpp checks once more before each rename.
#include <filesystem>
#include <string>
#include <vector>

namespace swingbank {

/// Protects what this process reads as input from now on, or forgets all of it. A process that is no command
/// may write what it has read.
void keep_inputs(bool on = true);
/// Notes a file that was read for the user. Its name may be of any spelling; links lead to their target.
void note_input(const std::filesystem::path& file);

/// A file that the command is going to write or to remove.
struct Output {
  std::filesystem::path file;
  std::string where;  ///< the option that names it or its folder
};
/// Throws InputError for each output that is the same file as an input (through links, hard links and other
/// spellings too), and for two outputs that are one file. Only after keep_inputs().
void require_inputs_kept(const std::vector<Output>& outputs);

}  // namespace swingbank
