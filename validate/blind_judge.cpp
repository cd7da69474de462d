#include "validate/blind_judge.hpp"

#include <algorithm>
#include <chrono>

#include "validate/plant_model.hpp"
#include "validate/record.hpp"

namespace swingbank::validate {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> event_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

BlindVerdict verdict_of(const Diagnosis& d) {
  BlindVerdict v;
  v.verdict = verdict_name(d.verdict);
  v.side = side_name(d.side);
  v.effects = d.effects;
  v.set = d.equivalent;
  v.why = d.sentence;
  if (v.effects.empty() && d.verdict == Verdict::confusable && !v.set.empty()) v.effects = {v.set.front()};
  return v;
}

}  // namespace

BlindJudge diagnosis_judge(const DiagnoseOptions& options) {
  return [options](const fs::path& folder) {
    const auto begin = std::chrono::steady_clock::now();
    BlindVerdict verdict;
    try {
      const PlantModel model = load_plant_model(folder / "model.toml");
      std::vector<Record> records;
      for (const auto& file : event_files(folder)) records.push_back(read_record(file, model.record_base));
      verdict = verdict_of(diagnose(model, std::move(records), options));
    } catch (const InputError& error) {
      verdict.verdict = "refused";
      verdict.why = error.what();
    }
    verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return verdict;
  };
}

}  // namespace swingbank::validate
