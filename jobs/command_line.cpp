#include "jobs/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

#include "base/inputs_kept.hpp"
#include "base/nearest_word.hpp"
#include "jobs/software.hpp"

namespace swingbank::jobs {
namespace {

/// Returns a validator for a one-sided range. CLI11's validator would print the largest double as the other
/// bound.
CLI::Validator number_that(bool (*accepts)(double), const std::string& name, const std::string& wanted) {
  return {[accepts, wanted](std::string& text) {
            double value = 0;
            if (CLI::detail::lexical_cast(text, value) && accepts(value)) return std::string();
            return "“" + text + "” is not a number " + wanted;
          },
          name};
}

/// Option names of version 0.1, each with its present name.
const std::map<std::string, std::string> kFormerNames = {{"--drive", "--playback"},
                                                         {"--fewest", "--sparse"},
                                                         {"--jump-threshold", "--step-threshold"},
                                                         {"--law", "--user-model"},
                                                         {"--spread", "--prior-sd"}};

int exit_code(const CLI::App& app, const CLI::ParseError& why) { return app.exit(why) == 0 ? 0 : 1; }

constexpr std::size_t kHelpWidth = 110, kNameWidth = 30;  // columns

/// Returns `text` wrapped to the width of the help's right column.
std::string wrapped(const std::string& text) {
  std::istringstream words(text);
  std::string word, lines;
  std::size_t column = 0;
  while (words >> word) {
    if (column > 0 && column + 1 + word.size() > kHelpWidth - kNameWidth) {
      lines += '\n';
      column = 0;
    } else if (column > 0) {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += word.size();
  }
  return lines;
}

/// Help formatter: groups of options in order of declaration, with "Output", "Expert" and "Help" last.
class GroupedHelp : public CLI::Formatter {
 public:
  GroupedHelp() { column_width(kNameWidth); }
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode) const override {
    std::vector<std::string> groups = app->get_groups();
    for (const char* last : {"Output", "Expert", "Help"}) {
      const auto at = std::ranges::find(groups, last);
      if (at != groups.end()) std::rotate(at, at + 1, groups.end());
    }
    std::string text = make_description(app) + make_usage(app, std::move(name)) + make_positionals(app);
    for (const auto& group : groups) {
      const auto options = app->get_options(
          [&](const CLI::Option* o) { return o->get_group() == group && o->nonpositional(); });
      if (!group.empty() && !options.empty()) text += make_group(group, false, options);
    }
    return text + "\n" + make_footer(app);
  }
  /// Omits the possibly long list of excluded options, because the error message names those that were given.
  /// Keeps the dots ("...") only if one mention of the option accepts several values.
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    constexpr std::string_view kSeveral = " ...";
    if (const auto at = text.find(kSeveral); at != std::string::npos && !option->get_allow_extra_args())
      text.erase(at, kSeveral.size());
    return text.substr(0, text.find(" Excludes:"));
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(option->get_description());
  }
};

}  // namespace

struct CommandLine::Parser {
  CLI::App app;
  std::optional<CLI::ParseError> ended = std::nullopt;
  std::string group = "Options", text = {}, examples = {};

  /// Returns all names of all options.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const CLI::Option* option : app.get_options()) {
      for (const auto& name : option->get_lnames()) all.push_back("--" + name);
      for (const auto& name : option->get_snames()) all.push_back("-" + name);
    }
    return all;
  }
  /// Returns "no positional arguments", or "no positional arguments except …".
  [[nodiscard]] std::string positionals() const {
    std::string all = "no positional arguments";
    const std::size_t none = all.size();
    for (const CLI::Option* option : app.get_options())
      if (option->get_positional()) all += (all.size() == none ? " except " : ", ") + option->get_name(true);
    return all;
  }
  /// Returns an error for each argument that is neither a known option nor an option's value, in the given
  /// order. Arguments after an unknown option count as its values.
  [[nodiscard]] std::vector<std::string> not_expected() const {
    std::vector<std::string> sentences;
    bool value = false;
    for (const std::string& word : app.remaining()) {
      const bool option = word.starts_with('-') && word.size() > 1;
      if (!option && value) continue;
      value = value || option;
      if (!option) {
        sentences.push_back(fmt::format("unexpected argument '{}': {} takes {}; see {} --help", word,
                                        app.get_name(), positionals(), app.get_name()));
        continue;
      }
      const std::string name = word.substr(0, word.find('='));
      const auto former = kFormerNames.find(name);
      const std::string nearest =
          former != kFormerNames.end() && std::ranges::count(names(), former->second) > 0
              ? former->second
              : nearest_word(name, names());
      sentences.push_back(fmt::format(
          "unknown option at '{}' ({} has no such option): {}", name, app.get_name(),
          nearest.empty() ? fmt::format("see {} --help", app.get_name()) : "did you mean " + nearest + "?"));
    }
    return sentences;
  }
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
  parser_->app.formatter(std::make_shared<GroupedHelp>());
  parser_->app.set_help_flag("-h,--help", "print this help and exit")->group("Help");
  parser_->app
      .set_version_flag("--version", name + " " + version() + ", commit " + commit(),
                        "print version and commit, and exit")
      ->group("Help");
}
CommandLine::~CommandLine() = default;
void CommandLine::describe(const std::string& text) { parser_->app.description(text); }

template <class T>
Option CommandLine::add(const std::string& names, T& value, const std::string& meaning) {
  return add(parser_->app.add_option(names, value), meaning);
}
using Text = const std::string&;
template Option CommandLine::add(Text, std::string&, Text);
template Option CommandLine::add(Text, std::filesystem::path&, Text);
template Option CommandLine::add(Text, int&, Text);
template Option CommandLine::add(Text, unsigned&, Text);
template Option CommandLine::add(Text, std::uint64_t&, Text);
template Option CommandLine::add(Text, double&, Text);
template Option CommandLine::add(Text, std::optional<std::uint64_t>&, Text);
template Option CommandLine::add(Text, std::optional<double>&, Text);
template Option CommandLine::add(Text, std::vector<std::string>&, Text);
template Option CommandLine::add(Text, std::vector<int>&, Text);

Option CommandLine::add_choice(const std::string& names, int& place, const std::vector<std::string>& words,
                               const std::string& meaning) {
  const std::function<void(const std::string&)> keep = [&place, words](const std::string& word) {
    place = static_cast<int>(std::find(words.begin(), words.end(), word) - words.begin());
  };
  CLI::Option* option = parser_->app.add_option_function(names, keep);
  option->default_str(words.at(static_cast<std::size_t>(place)));
  return add(option, meaning).one_of(words);
}
Option CommandLine::add_flag(const std::string& names, bool& on, const std::string& meaning) {
  return add(parser_->app.add_flag(names, on), meaning);
}
Option CommandLine::add_flag_off(const std::string& name, bool& on, const std::string& meaning) {
  return add(parser_->app.add_flag_callback(name, [&on] { on = false; }), meaning);
}
Option CommandLine::add(CLI::Option* option, const std::string& meaning) {
  return Option(option->description(meaning)->group(parser_->group));
}
void CommandLine::group(const std::string& name) { parser_->group = name; }
void CommandLine::footer(const std::string& text) {
  parser_->text = text;
  parser_->app.footer(parser_->examples + (parser_->examples.empty() ? "" : "\n") + text);
}
void CommandLine::example(const std::string& text) {
  parser_->examples += (parser_->examples.empty() ? "Example:\n  " : "  ") + text + "\n";
  parser_->app.footer(parser_->examples + (parser_->text.empty() ? "" : "\n") + parser_->text);
}

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
int CommandLine::end() const {
  if (!parser_->ended) return 0;
  const auto wrong = parser_->not_expected();
  if (parser_->ended->get_exit_code() == 0 || wrong.empty()) return exit_code(parser_->app, *parser_->ended);
  for (const auto& sentence : wrong) fmt::print(stderr, "{}\n", sentence);
  if (std::ranges::none_of(wrong, [](const auto& s) { return s.ends_with("--help"); }))
    fmt::print(stderr, "Run with --help for more information.\n");
  return 1;
}
int CommandLine::lacks(const std::string& what) const {
  return exit_code(parser_->app, CLI::RequiredError(what));
}

}  // namespace swingbank::jobs
