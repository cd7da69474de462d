#include "validate/blind/score/judge.hpp"

#include <algorithm>
#include <chrono>

#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::blind::score {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> event_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

BlindVerdict verdict_of(const diagnose::Diagnosis& d) {
  BlindVerdict v;
  v.verdict = diagnose::verdict_name(d.verdict);
  v.side = hypothesis::side_name(d.side);
  v.effects = d.effects;
  v.set = d.equivalent;
  v.why = d.sentence;
  if (v.effects.empty() && d.verdict == diagnose::Verdict::confusable && !v.set.empty())
    v.effects = {v.set.front()};
  return v;
}

}  // namespace

BlindJudge diagnosis_judge(const diagnose::DiagnoseOptions& options) {
  return [options](const fs::path& folder) {
    const auto begin = std::chrono::steady_clock::now();
    BlindVerdict verdict;
    try {
      const plant::PlantModel model = plant::load_plant_model(folder / "model.toml");
      std::vector<record::Record> records;
      for (const auto& file : event_files(folder))
        records.push_back(record::read_record(file, model.record_base));
      verdict = verdict_of(diagnose::diagnose(model, std::move(records), options));
    } catch (const InputError& error) {
      verdict.verdict = "refused";
      verdict.why = error.what();
    }
    verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return verdict;
  };
}

}  // namespace swingbank::validate::blind::score
