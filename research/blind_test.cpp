// swingbank blind-test: generates records with a hidden effect, diagnoses them and scores the verdicts.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>

#include "base/launcher.hpp"
#include "base/stop_signal.hpp"
#include "base/write_file.hpp"
#include "jobs/command_line.hpp"
#include "jobs/item_progress.hpp"
#include "mpi/items/one_process.hpp"
#include "mpi/ranks/item_ranks.hpp"
#include "mpi/ranks/session.hpp"
#include "research/blind/cases/case.hpp"
#include "research/blind/cases/plan.hpp"
#include "research/blind/score/judge.hpp"
#include "research/blind/score/score.hpp"

namespace swingbank::research::blind_test_command {
namespace {
using namespace swingbank::research;
using namespace validate;
namespace fs = std::filesystem;

struct Options {
  std::string config, targets, out, judge, part = "1/1";
  std::vector<std::string> kinds;
  int make = 0, threads = -1;
  std::uint64_t seed = 1;
  double size = 0;
  bool diagnose = false, score = false;
  double limit = 7200.0;  ///< time limit of one case [s]; 0: none
};

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Outcome of an item: done by this run, done by an earlier run, or failed.
enum class Fate { done, was_there, failed };
/// Returns an outcome and its text, packed as a message to rank 0.
std::string packed(Fate fate, const std::string& text) {
  return std::to_string(static_cast<int>(fate)) + text;
}

struct Counts {
  int done = 0, there = 0, failed = 0;
};

/// Distributes the cases of this part over the ranks. Returns the exit code, the same on all ranks.
int share_cases(const mpi::items::Ranks& ranks, const Options& o, std::size_t count, const std::string& unit,
                const std::function<std::string(std::size_t)>& work, Counts& counts) {
  const auto [part, parts] = blind::cases::read_part(o.part);
  mpi::items::SharedItems shared;
  for (std::size_t k = 0; k < count; ++k)
    if (static_cast<int>(k % static_cast<std::size_t>(parts)) == part - 1) shared.items.push_back(k);
  jobs::ItemProgress progress(unit, shared.items.size());
  shared.work = work;
  shared.limit = o.limit;
  shared.name = blind::cases::case_name;
  shared.done = [&](std::size_t, const std::string& result) {
    const auto fate = static_cast<Fate>(result.front() - '0');
    (fate == Fate::done ? counts.done : fate == Fate::failed ? counts.failed : counts.there) += 1;
    progress.line(result.substr(1), fate == Fate::was_there);
  };
  if (!ranks.share_items(shared)) {
    if (ranks.rank() == 0)
      fmt::print("stopped on a signal; finished cases are safe: run the same command again to continue\n");
    return kSubmitAgain;
  }
  return ranks.from_first(counts.failed == 0 ? 0 : 1);
}

/// Generates one case of the plan. If the generation throws an exception, returns a failed case, so that a
/// long run continues.
std::string make_one(const Options& o, const blind::cases::BlindConfig& config,
                     const blind::cases::BlindSpec& spec, const std::string& name) {
  const fs::path folder = fs::path(o.out) / "cases" / name;
  if (fs::exists(folder)) return packed(Fate::was_there, name + " (existed already)");
  const auto start = std::chrono::steady_clock::now();
  try {
    const blind::cases::BlindCase one = blind::cases::make_blind_case(config, spec);
    blind::cases::write_blind_case(one, config, name, folder, fs::path(o.out) / "truth" / (name + ".json"));
    return packed(Fate::done, fmt::format("{}, {} events, {} draws, {:.1f} s", name, one.records.size(),
                                          one.attempts, seconds_since(start)));
  } catch (const std::exception& error) {
    return packed(Fate::failed, name + ": " + error.what());
  }
}

int make(const mpi::items::Ranks& ranks, const Options& o) {
  blind::cases::BlindConfig config;
  blind::cases::BlindPlan plan;
  ranks.agree(o.config, [&] {
    config = blind::cases::load_blind_config(o.config);
    plan = blind::cases::plan_blind(config, o.kinds, o.make, o.seed, o.size);
  });
  ranks.agree(o.out, [&] {
    if (ranks.rank() == 0) blind::cases::settle_plan(plan, config, o.out);
  });
  const auto begin = std::chrono::steady_clock::now();
  Counts counts;
  const int code = share_cases(
      ranks, o, plan.cases.size(), "cases",
      [&](std::size_t k) { return make_one(o, config, plan.cases[k], blind::cases::case_name(k)); }, counts);
  if (ranks.rank() == 0)
    fmt::print("made {} cases in {:.1f} s, {} existed already, {} failed: {}\n", counts.done,
               seconds_since(begin), counts.there, counts.failed, o.out);
  return code;
}

std::size_t count_cases(const fs::path& run) {
  std::size_t n = 0;
  for (const auto& entry : fs::directory_iterator(run / "cases"))
    n += entry.path().filename().string().front() != '.' ? 1 : 0;
  return n;
}

/// Judges case k of `count`.
std::string judge_one(const fs::path& run, const blind::score::BlindJudge& asked, std::size_t k,
                      std::size_t count) {
  std::string said;
  try {
    const auto faults = blind::score::judge_cases(
        run, asked, {static_cast<int>(k) + 1, static_cast<int>(count)},
        [&](const std::string& name, const blind::score::BlindVerdict& v) {
          said = fmt::format("{}: {}{}{}, {:.1f} s", name, v.verdict, v.effects.empty() ? "" : " ",
                             v.effects.empty() ? "" : v.effects.front(), v.seconds);
        });
    if (!faults.empty()) return packed(Fate::failed, faults.front());
  } catch (const std::exception& error) {
    return packed(Fate::failed, error.what());
  }
  return said.empty() ? packed(Fate::was_there, "has a verdict already") : packed(Fate::done, said);
}

int judge(const mpi::items::Ranks& ranks, const Options& o) {
  const fs::path run = o.out;
  std::size_t count = 0;
  ranks.agree(o.out, [&] {
    if (fs::is_directory(run / "cases"))
      count = count_cases(run);
    else
      throw InputError({"no cases of a blind test", o.out, "the folder has no subfolder cases",
                        "make cases first, with --make"});
  });
  diagnose::DiagnoseOptions options;
  options.threads = o.threads >= 0 ? o.threads : ranks.on_this_machine() > 1 ? 1 : 0;
  const blind::score::BlindJudge asked = o.diagnose ? blind::score::diagnosis_judge(options)
                                                    : blind::score::program_judge(o.judge, run / "verdicts");
  Counts counts;
  const int code = share_cases(
      ranks, o, count, "cases", [&](std::size_t k) { return judge_one(run, asked, k, count); }, counts);
  if (ranks.rank() == 0) fmt::print("judged {} cases, {} failed: {}\n", counts.done, counts.failed, o.out);
  return code;
}

int score(const Options& o) {
  if (o.targets.empty())
    throw InputError({"no targets", "--targets", "--score compares the rates with target rates",
                      "give configs/blind/targets.toml"});
  const blind::score::BlindScore result = blind::score::score_blind(o.out, o.targets);
  const std::string text = blind::score::score_markdown(result);
  write_file(fs::path(o.out) / "score.md", text);
  write_file(fs::path(o.out) / "score.json", blind::score::score_json(result).dump(1) + "\n");
  fmt::print("{}", text);
  return 0;
}

void check(const Options& o) {
  if (o.diagnose && !o.judge.empty())
    throw InputError({"two sources of verdicts", "--diagnose and --judge", "each case has one verdict",
                      "give one of them"});
  if (o.make <= 0 && !o.diagnose && o.judge.empty() && !o.score)
    throw InputError({"nothing to do", "blind-test", "none of --make, --diagnose, --judge, --score was given",
                      "give at least one of them"});
  if (o.make > 0 && o.config.empty())
    throw InputError({"no config", "--config", "it defines the distribution of the cases",
                      "give configs/blind/cases.toml"});
}

int blind_test(const mpi::items::Ranks& ranks, const Options& o) {
  check(o);
  if (o.make > 0)
    if (const int code = make(ranks, o); code != 0) return code;
  const int code = o.diagnose || !o.judge.empty() ? judge(ranks, o) : 0;
  if (code == kSubmitAgain || !o.score) return code;
  return std::max(code, ranks.rank() == 0 ? score(o) : 0);
}

/// Runs the command on all ranks, with MPI if a launcher started it. All ranks end with the same error, which
/// rank 0 prints.
int on_ranks(int argc, char** argv, const Options& o) {
  std::optional<mpi::ranks::MpiSession> session;
  std::unique_ptr<mpi::items::Ranks> of_run = std::make_unique<mpi::items::OneProcess>();
  if (launched()) {
    session.emplace(&argc, &argv);
    of_run = std::make_unique<mpi::ranks::ItemRanks>(MPI_COMM_WORLD);
  }
  const mpi::items::Ranks& ranks = *of_run;
  catch_stop_signals();
  try {
    return blind_test(ranks, o);
  } catch (const std::exception& error) {
    if (ranks.rank() == 0) fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

}  // namespace

int run(jobs::CommandLine& line, int argc, char** argv) {
  Options o;
  line.add("--config", o.config, "distribution of the cases of --make: configs/blind/cases.toml, tiny.toml");
  line.add("--out", o.out, "folder of the run: cases/, truth/, verdicts/, score.md").required();
  line.add("--make", o.make, "number of cases to make; existing ones are kept");
  line.add("--seed", o.seed, "seed of the run").shows_default();
  line.add(
          "--kinds", o.kinds,
          "kinds to hide, comma-separated: kinds of the config, A+B for two at once, none, listed, odd (unlisted), "
          "pairs (default: the mixture of docs/how-to/blind-test.md)")
      .comma_separated();
  line.add("--size", o.size, "size of every effect, in detection limits (default: drawn)");
  line.add_flag("--diagnose", o.diagnose,
                "diagnose every case without a verdict, as swingbank diagnose does");
  line.add("--judge", o.judge,
           "program to run as PROGRAM CASE_FOLDER VERDICT_FILE on every case without a verdict");
  line.add_flag("--score", o.score, "compare the verdicts with the truth: score.md, score.json");
  line.add("--targets", o.targets, "target rates, for example configs/blind/targets.toml");
  line.add("--case-timeout", o.limit,
           "time limit per case [s]; exceeding it ends the run (default 7200; 0: none)")
      .not_negative();
  line.add("--threads", o.threads,
           "threads of one diagnosis; 0: one per core (default: 0, or 1 if several ranks share the machine)")
      .between(0, 4096);
  line.add("--part", o.part,
           "K/N: only every N-th case, from the K-th; for job arrays. Under mpirun the ranks share those")
      .shows_default();
  line.example(
      "swingbank blind-test --config configs/blind/tiny.toml --make 5 --diagnose --score --out blind");
  if (!line.parse(argc, argv)) return line.end();
  return on_ranks(argc, argv, o);
}

}  // namespace swingbank::research::blind_test_command
