#pragma once
// Command-line options, their help and their errors. The interface hides CLI11's templates, so that CLI11 is
// compiled once instead of in every command.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class Option;
}

namespace swingbank::jobs {

/// Handle of a declared option, to add constraints.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  const Option& required() const;
  const Option& shows_default() const;  ///< show the variable's initial value in the help
  const Option& one_of(const std::vector<std::string>& words) const;
  const Option& between(int low, int high) const;
  const Option& between(double low, double high) const;
  const Option& positive() const;
  const Option& not_negative() const;
  const Option& existing_file() const;
  const Option& comma_separated() const;       ///< one argument may contain several values
  const Option& one_value_a_mention() const;   ///< for a list: one value per mention of the option
  const Option& needs(Option other) const;     ///< invalid without `other`
  const Option& excludes(Option other) const;  ///< invalid together with `other`

 private:
  CLI::Option* option_;  ///< owned by the CommandLine
};

/// Parser of a command line. The variables passed to add() must exist until parse(). Option names are
/// separated by commas; a name without dashes is a positional argument.
class CommandLine {
 public:
  /// `name`: name of the command, for example "swingbank add".
  CommandLine(const std::string& summary, const std::string& name);
  ~CommandLine();
  /// Replaces the summary at the head of the help by a text of several lines.
  void describe(const std::string& text);

  /// Adds an option. T: std::string, std::filesystem::path, int, unsigned, std::uint64_t, double, an optional
  /// std::uint64_t or double, or a vector of std::string or int.
  template <class T>
  Option add(const std::string& names, T& value, const std::string& meaning);
  /// Adds an option whose value is one of `words`; sets `place` to its index, from 0.
  Option add_choice(const std::string& names, int& place, const std::vector<std::string>& words,
                    const std::string& meaning);
  Option add_flag(const std::string& names, bool& on, const std::string& meaning);
  /// Adds a flag that sets `on` to false.
  Option add_flag_off(const std::string& name, bool& on, const std::string& meaning);
  /// Sets the heading in the help for options that are added after this call. "Output" and "Expert" come
  /// last.
  void group(const std::string& name);
  void footer(const std::string& text);
  /// Adds an example command line below the options in the help.
  void example(const std::string& text);

  /// Parses the arguments and prints nothing. Returns false if the user asked for help or an option is
  /// invalid.
  bool parse(int argc, char** argv);
  /// Prints the help or the error if parse() returned false. Returns the exit code.
  [[nodiscard]] int end() const;
  /// Prints the error that the option `what` is missing. Returns the exit code.
  [[nodiscard]] int lacks(const std::string& what) const;

 private:
  struct Parser;
  Option add(CLI::Option* option, const std::string& meaning);
  std::unique_ptr<Parser> parser_;
};

/// Declares the options on `line` (summary and name are set), parses the arguments and runs the command.
/// Returns the exit code: 0 success, 1 an error that was printed, others as the command's help states.
/// Exceptions become error messages (guarded.hpp).
using CommandFunction = int(CommandLine& line, int argc, char** argv);

}  // namespace swingbank::jobs
