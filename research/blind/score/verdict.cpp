#include "research/blind/score/verdict.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>

#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/write_file.hpp"

namespace swingbank::research::blind::score {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::vector<std::string> kVerdicts = {"adequate", "missing", "confusable", "unexplained", "refused"};
const std::vector<std::string> kSides = {"mechanical", "excitation", "machine", "measurement", "none"};

std::string listing(const std::vector<std::string>& words) {
  std::string all;
  for (const auto& word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

std::string word(const json& j, const char* key, const std::vector<std::string>& words, const fs::path& file,
                 Problems& problems) {
  const auto at = j.find(key);
  const bool text = at != j.end() && at->is_string();
  const std::string value = text ? at->get<std::string>() : "";
  if (std::ranges::find(words, value) == words.end())
    problems.add("'" + value + "'", file.string() + ", key " + key, "it must be one of " + listing(words),
                 "write one of these");
  return value;
}

std::vector<std::string> names(const json& j, const char* key, const fs::path& file, Problems& problems) {
  std::vector<std::string> list;
  const auto at = j.find(key);
  bool sound = at != j.end() && at->is_array();
  if (sound)
    for (const auto& name : *at) {
      sound = sound && name.is_string();
      if (name.is_string()) list.push_back(name.get<std::string>());
    }
  if (!sound)
    problems.add("no list of names", file.string() + ", key " + key,
                 "a verdict requires one, which may be empty", "write it like [\"SEXS\"]");
  return list;
}

/// Reads the probabilities, [["SEXS", 0.97], ...]; empty if the verdict has none.
std::vector<std::pair<std::string, double>> probabilities(const json& j, const fs::path& file,
                                                          Problems& problems) {
  const auto at = j.find("probabilities");
  if (at == j.end()) return {};
  try {
    auto list = at->get<std::vector<std::pair<std::string, double>>>();
    const bool sound =
        std::ranges::all_of(list, [](const auto& e) { return e.second >= 0 && e.second <= 1; });
    if (sound && std::ranges::is_sorted(list, std::greater<>(), &std::pair<std::string, double>::second))
      return list;
  } catch (const json::exception&) {  // reported below
  }
  problems.add("no list of probabilities", file.string() + ", key probabilities",
               "it holds pairs of a name and a number from 0 to 1, the most probable first",
               "write it like [[\"SEXS\", 0.9], [\"none of these\", 0.1]], or leave it out");
  return {};
}

/// Runs the program with two arguments. Returns its exit code, or -1 if it did not exit.
int run(const std::string& program, const fs::path& folder, const fs::path& file) {
  const pid_t child = fork();
  if (child == 0) {
    execlp(program.c_str(), program.c_str(), folder.c_str(), file.c_str(), nullptr);
    _exit(127);
  }
  int status = -1;
  if (child < 0 || waitpid(child, &status, 0) < 0 || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

}  // namespace

BlindVerdict read_verdict(const fs::path& file) {
  std::ifstream in(file);
  const json j = json::parse(in, nullptr, false);
  if (!j.is_object())
    throw InputError({"no verdict", file.string(), "it is not a JSON object",
                      "write the keys verdict, effects, "
                      "set, side, seconds"});
  Problems problems;
  BlindVerdict v;
  v.verdict = word(j, "verdict", kVerdicts, file, problems);
  v.side = word(j, "side", kSides, file, problems);
  v.effects = names(j, "effects", file, problems);
  v.set = names(j, "set", file, problems);
  if (j.contains("wrong")) v.wrong = names(j, "wrong", file, problems);
  const auto seconds = j.find("seconds");
  if (seconds != j.end() && seconds->is_number() && seconds->get<double>() >= 0)
    v.seconds = seconds->get<double>();
  else
    problems.add("no wall time", file.string() + ", key seconds", "it must be a number of seconds, 0 or more",
                 "write the duration of the diagnosis");
  if (const auto why = j.find("why"); why != j.end() && why->is_string()) v.why = why->get<std::string>();
  v.probabilities = probabilities(j, file, problems);
  if (const auto basis = j.find("basis"); basis != j.end()) v.basis = *basis;
  problems.raise();
  return v;
}

std::string verdict_json(const BlindVerdict& v) {
  json j = {{"verdict", v.verdict}, {"effects", v.effects}, {"set", v.set},
            {"side", v.side},       {"seconds", v.seconds}, {"why", v.why}};
  if (!v.wrong.empty()) j["wrong"] = v.wrong;
  if (!v.probabilities.empty()) j["probabilities"] = v.probabilities;
  if (!v.basis.is_null()) j["basis"] = v.basis;
  return j.dump(1) + "\n";
}

BlindJudge program_judge(const std::string& program, const fs::path& work) {
  return [program, work](const fs::path& folder) {
    fs::create_directories(work);
    const fs::path file = work / (folder.filename().string() + ".judged.json");
    fs::remove(file);
    const int code = run(program, folder, file);
    if (code != 0)
      throw InputError({"the program of --judge ended with code " + std::to_string(code), folder.string(),
                        program + " must write a verdict and end with 0",
                        code == 127 ? "give the path of a program" : "run it by hand on that folder"});
    const BlindVerdict verdict = read_verdict(file);
    fs::remove(file);
    return verdict;
  };
}

std::vector<std::string> judge_cases(
    const fs::path& folder, const BlindJudge& judge, std::pair<int, int> part,
    const std::function<void(const std::string&, const BlindVerdict&)>& progress) {
  std::vector<fs::path> cases;
  for (const auto& entry : fs::directory_iterator(folder / "cases"))
    if (entry.path().filename().string().front() != '.') cases.push_back(entry.path());
  std::ranges::sort(cases);
  std::vector<std::string> faults;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const std::string name = cases[k].filename().string();
    const fs::path file = folder / "verdicts" / (name + ".json");
    if (static_cast<int>(k) % part.second != part.first - 1 || fs::exists(file)) continue;
    try {
      const auto begin = std::chrono::steady_clock::now();
      BlindVerdict verdict = judge(cases[k]);
      if (verdict.seconds == 0)
        verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      write_file(file, verdict_json(verdict));
      progress(name, verdict);
    } catch (const InputError& error) {
      faults.push_back(name + ": " + error.what());
    }
  }
  return faults;
}

}  // namespace swingbank::research::blind::score
