#include "jobs/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "base/inputs_kept.hpp"
#include "jobs/software.hpp"

namespace swingbank::jobs {
namespace {

/// CLI11's own bounds would print the largest number there is.
CLI::Validator number_that(bool (*holds)(double), const std::string& name, const std::string& wanted) {
  return {[holds, wanted](std::string& text) {
            double value = 0;
            if (CLI::detail::lexical_cast(text, value) && holds(value)) return std::string();
            return "“" + text + "” is not a number " + wanted;
          },
          name};
}

int exit_code(const CLI::App& app, const CLI::ParseError& why) { return app.exit(why) == 0 ? 0 : 1; }

}  // namespace

struct CommandLine::Parser {
  CLI::App app;
  std::optional<CLI::ParseError> ended = std::nullopt;
};

const Option& Option::required() const {
  option_->required();
  return *this;
}
const Option& Option::shows_default() const {
  option_->capture_default_str();
  return *this;
}
const Option& Option::one_of(const std::vector<std::string>& words) const {
  option_->check(CLI::IsMember(words));
  return *this;
}
const Option& Option::between(int low, int high) const {
  option_->check(CLI::Range(low, high));
  return *this;
}
const Option& Option::between(double low, double high) const {
  option_->check(CLI::Range(low, high));
  return *this;
}
const Option& Option::positive() const {
  option_->check(number_that(
      +[](double value) { return value > 0; }, "POSITIVE", "above 0"));
  return *this;
}
const Option& Option::not_negative() const {
  option_->check(number_that(
      +[](double value) { return value >= 0; }, "NONNEGATIVE", "of 0 or more"));
  return *this;
}
const Option& Option::existing_file() const {
  option_->check(CLI::ExistingFile);
  return *this;
}
const Option& Option::comma_separated() const {
  option_->delimiter(',');
  return *this;
}
const Option& Option::one_value_a_mention() const {
  option_->allow_extra_args(false);
  return *this;
}
const Option& Option::needs(Option other) const {
  option_->needs(other.option_);
  return *this;
}
const Option& Option::excludes(Option other) const {
  option_->excludes(other.option_);
  return *this;
}

CommandLine::CommandLine(const std::string& summary, const std::string& name)
    : parser_(new Parser{CLI::App(summary, name)}) {
  parser_->app.set_version_flag("--version", name + " " + version() + ", commit " + commit(),
                                "print version and commit, and end");
}
CommandLine::~CommandLine() = default;

Option CommandLine::add(const std::string& names, std::string& value, const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, std::filesystem::path& value, const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, int& value, const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, unsigned& value, const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, std::uint64_t& value, const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, double& value, const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, std::optional<std::uint64_t>& value,
                        const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, std::optional<double>& value, const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, std::vector<std::string>& value,
                        const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add(const std::string& names, std::vector<int>& value, const std::string& meaning) {
  return Option(parser_->app.add_option(names, value, meaning));
}
Option CommandLine::add_choice(const std::string& names, int& place, const std::vector<std::string>& words,
                               const std::string& meaning) {
  const std::function<void(const std::string&)> keep = [&place, words](const std::string& word) {
    place = static_cast<int>(std::find(words.begin(), words.end(), word) - words.begin());
  };
  CLI::Option* option = parser_->app.add_option_function(names, keep, meaning);
  option->default_str(words.at(static_cast<std::size_t>(place)));
  return Option(option).one_of(words);
}
Option CommandLine::add_flag(const std::string& names, bool& on, const std::string& meaning) {
  return Option(parser_->app.add_flag(names, on, meaning));
}
Option CommandLine::add_flag_off(const std::string& name, bool& on, const std::string& meaning) {
  return Option(parser_->app.add_flag_callback(
      name, [&on] { on = false; }, meaning));
}
void CommandLine::footer(const std::string& text) { parser_->app.footer(text); }

bool CommandLine::parse(int argc, char** argv) {
  keep_inputs();
  try {
    parser_->app.parse(argc, argv);
    return true;
  } catch (const CLI::ParseError& why) {
    parser_->ended = why;
    return false;
  }
}
int CommandLine::end() const { return parser_->ended ? exit_code(parser_->app, *parser_->ended) : 0; }
int CommandLine::lacks(const std::string& what) const {
  return exit_code(parser_->app, CLI::RequiredError(what));
}

}  // namespace swingbank::jobs
