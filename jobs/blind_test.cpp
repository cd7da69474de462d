// swingbank blind-test: makes records in which an effect is hidden, and scores what a diagnosis said of them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "validate/blind_case.hpp"
#include "validate/blind_judge.hpp"
#include "validate/blind_plan.hpp"
#include "validate/blind_score.hpp"
#include "validate/write_file.hpp"

namespace {
using namespace swingbank;
using namespace swingbank::validate;
namespace fs = std::filesystem;

struct Options {
  std::string config, targets, out, judge, part = "1/1";
  std::vector<std::string> kinds;
  int make = 0;
  std::uint64_t seed = 1;
  double size = 0;
  bool diagnose = false, score = false;
};

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

int make(const Options& o) {
  const BlindConfig config = load_blind_config(o.config);
  const BlindPlan plan = plan_blind(config, o.kinds, o.make, o.seed, o.size);
  settle_plan(plan, config, o.out);
  const auto [part, parts] = read_part(o.part);
  const auto begin = std::chrono::steady_clock::now();
  int made = 0, there = 0, failed = 0;
  for (std::size_t k = 0; k < plan.cases.size(); ++k) {
    if (static_cast<int>(k % static_cast<std::size_t>(parts)) != part - 1) continue;
    const std::string name = case_name(k);
    const fs::path folder = fs::path(o.out) / "cases" / name;
    if (fs::exists(folder)) {
      ++there;
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    try {
      const BlindCase one = make_blind_case(config, plan.cases[k]);
      write_blind_case(one, config, name, folder, fs::path(o.out) / "truth" / (name + ".json"));
      ++made;
      fmt::print("{} of {}: {}, {} events, {} draws, {:.1f} s\n", k + 1, plan.cases.size(), name,
                 one.records.size(), one.attempts, seconds_since(start));
    } catch (const InputError& error) {  // one kind that cannot be drawn does not stop a long run
      ++failed;
      fmt::print(stderr, "{} of {}: {}\n", k + 1, plan.cases.size(), error.what());
    }
    std::fflush(stdout);
  }
  fmt::print("made {} cases in {:.1f} s, {} were there already, {} failed: {}\n", made, seconds_since(begin),
             there, failed, o.out);
  return failed == 0 ? 0 : 1;
}

int judge(const Options& o) {
  const fs::path run = o.out;
  if (!fs::is_directory(run / "cases"))
    throw InputError({"no run", o.out, "it has no folder cases", "make cases first, with --make"});
  int judged = 0;
  const BlindJudge asked = o.diagnose ? diagnosis_judge() : program_judge(o.judge, run / "verdicts");
  const auto faults =
      judge_cases(run, asked, read_part(o.part), [&](const std::string& name, const BlindVerdict& v) {
        ++judged;
        fmt::print("{}: {}{}{}, {:.1f} s\n", name, v.verdict, v.effects.empty() ? "" : " ",
                   v.effects.empty() ? "" : v.effects.front(), v.seconds);
        std::fflush(stdout);
      });
  for (const auto& fault : faults) fmt::print(stderr, "{}\n", fault);
  fmt::print("judged {} cases, {} failed: {}\n", judged, faults.size(), o.out);
  return faults.empty() ? 0 : 1;
}

int score(const Options& o) {
  if (o.targets.empty())
    throw InputError(
        {"no targets", "--targets", "a score is held against them", "give configs/blind/targets.toml"});
  const BlindScore result = score_blind(o.out, o.targets);
  const std::string text = score_markdown(result);
  write_file(fs::path(o.out) / "score.md", text);
  write_file(fs::path(o.out) / "score.json", score_json(result).dump(1) + "\n");
  fmt::print("{}", text);
  return 0;
}

int blind_test(const Options& o) {
  const bool asks = o.diagnose || !o.judge.empty();
  if (o.diagnose && !o.judge.empty())
    throw InputError({"two judges", "--diagnose and --judge", "a run has one", "give one of them"});
  if (o.make <= 0 && !asks && !o.score)
    throw InputError({"nothing to do", "blind-test", "none of --make, --diagnose, --judge, --score was given",
                      "give one of them, or several"});
  if (o.make > 0) {
    if (o.config.empty())
      throw InputError(
          {"no config", "--config", "cases are drawn from one", "give configs/blind/cases.toml"});
    if (const int code = make(o); code != 0) return code;
  }
  const int code = asks ? judge(o) : 0;
  return o.score ? std::max(code, score(o)) : code;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{SWINGBANK_SUMMARY, "swingbank blind-test"};
  Options o;
  app.add_option("--config", o.config, "what --make draws from: configs/blind/cases.toml, tiny.toml");
  app.add_option("--out", o.out, "folder of the run: cases/, truth/, verdicts/, score.md")->required();
  app.add_option("--make", o.make, "make that many cases (those that are there stay)");
  app.add_option("--seed", o.seed, "seed of the run")->capture_default_str();
  app.add_option(
         "--kinds", o.kinds,
         "kinds to hide, comma-separated: kinds of the config, A+B for two at once, none, listed, odd, "
         "pairs (default: the issue's mixture)")
      ->delimiter(',');
  app.add_option("--size", o.size, "size of every effect, in detection limits (default: drawn)");
  app.add_flag("--diagnose", o.diagnose, "diagnose every case without a verdict, as swingbank diagnose does");
  app.add_option("--judge", o.judge,
                 "program to run as PROGRAM CASE_FOLDER VERDICT_FILE on every case without a verdict");
  app.add_flag("--score", o.score, "hold the verdicts against the truth: score.md, score.json");
  app.add_option("--targets", o.targets, "rates asked for, configs/blind/targets.toml");
  app.add_option("--part", o.part, "K/N: only every N-th case, from the K-th; for ranks and job arrays")
      ->capture_default_str();
  try {
    app.parse(argc, argv);
    return blind_test(o);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
