#pragma once
// What a person may write behind a command: its options, their help, and what is said of a wrong one. Without
// templates, so that CLI11 is compiled once and not in every command.
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

/// One option of a command line, to say more of it.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  const Option& required() const;
  const Option& shows_default() const;  ///< the help shows the value that the variable has now
  const Option& one_of(const std::vector<std::string>& words) const;
  const Option& between(int low, int high) const;
  const Option& between(double low, double high) const;
  const Option& positive() const;
  const Option& not_negative() const;
  const Option& existing_file() const;
  const Option& comma_separated() const;      ///< one word may hold several values
  const Option& one_value_a_mention() const;  ///< of a list: the words after the first are none of its values
  const Option& needs(Option other) const;    ///< without it this one is refused
  const Option& excludes(Option other) const;  ///< beside it this one is refused

 private:
  CLI::Option* option_;  ///< held by its CommandLine
};

/// The variables given to it must live until the command line is parsed. Names are separated by commas; one
/// without dashes is told by its place.
class CommandLine {
 public:
  /// `name`: "swingbank add".
  CommandLine(const std::string& summary, const std::string& name);
  ~CommandLine();

  Option add(const std::string& names, std::string& value, const std::string& meaning);
  Option add(const std::string& names, std::filesystem::path& value, const std::string& meaning);
  Option add(const std::string& names, int& value, const std::string& meaning);
  Option add(const std::string& names, unsigned& value, const std::string& meaning);
  Option add(const std::string& names, std::uint64_t& value, const std::string& meaning);
  Option add(const std::string& names, double& value, const std::string& meaning);
  Option add(const std::string& names, std::optional<std::uint64_t>& value, const std::string& meaning);
  Option add(const std::string& names, std::optional<double>& value, const std::string& meaning);
  Option add(const std::string& names, std::vector<std::string>& value, const std::string& meaning);
  Option add(const std::string& names, std::vector<int>& value, const std::string& meaning);
  /// One of several words; `place` becomes its place among them, from 0.
  Option add_choice(const std::string& names, int& place, const std::vector<std::string>& words,
                    const std::string& meaning);
  Option add_flag(const std::string& names, bool& on, const std::string& meaning);
  /// A flag that makes `on` false.
  Option add_flag_off(const std::string& name, bool& on, const std::string& meaning);
  /// Heading in the help of the options that are added from now on. "Output" and "Expert" stand last.
  void group(const std::string& name);
  void footer(const std::string& text);
  /// A command line to copy; stands below the options in the help.
  void example(const std::string& text);

  /// Returns false if the command has no work to do: help was asked for, or an option is wrong. Prints
  /// nothing.
  bool parse(int argc, char** argv);
  /// After that: prints the help or the fault. Returns the exit code.
  [[nodiscard]] int end() const;
  /// Prints that `what` is required. Returns the exit code.
  [[nodiscard]] int lacks(const std::string& what) const;

 private:
  struct Parser;
  Option add(CLI::Option* option, const std::string& meaning);
  std::unique_ptr<Parser> parser_;
};

}  // namespace swingbank::jobs
