#include "sim/grid/coverage.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "sim/formats/dyd.hpp"
#include "sim/grid/detail/dyr_models.hpp"

namespace swingbank::sim::grid {
namespace {

/// Beginning of the names of missing models, and why they are missing.
struct Missing {
  std::string_view beginning, why;
};
constexpr Missing kMissing[] = {
    {"CMLD", "composite load, not modelled"},
    {"CMPLD", "composite load, not modelled"},
    {"SVSMO2", "static var system of stepped branches, not modelled"},
    {"SVSMO3", "static var system of a converter, not modelled"},
    {"VSCHVDC", "a model of STEPS, not of PSS/E"},
    {"VSG1", "a model of STEPS, not of PSS/E"},
    {"ESURRY", "the order of its parameters is not public"},
};
std::string why_missing(std::string_view name) {
  for (const Missing& m : kMissing)
    if (name.starts_with(m.beginning)) return std::string(m.why);
  return {};
}

class CoverageTaker {
 public:
  void read(const std::filesystem::path& file) {
    const formats::DyrSurvey survey =
        formats::is_dyd(file) ? formats::survey_dyd(file).dyr : formats::survey_dyr(file);
    ++out_.files;
    for (const formats::DyrRecord& record : survey.records)
      count(record, file.string() + ":" + std::to_string(record.line));
    for (const Problem& p : survey.faults) out_.faults.push_back(p.sentence());
  }
  Coverage end() {
    for (const auto& [name, model] : models_) {
      out_.models.push_back(model);
      out_.records += model.records;
      out_.covered += model.covered();
    }
    std::ranges::stable_sort(out_.models, std::greater{}, &ModelCoverage::records);
    return std::move(out_);
  }

 private:
  void count(const formats::DyrRecord& record, const std::string& where) {
    const std::string name = name_of(record);
    ModelCoverage& model = models_[name];
    const Effect* effect = effect_of_dyr(record).first;
    if (++model.records == 1) {
      model.name = name;
      model.first_place = where;
      if (effect) {
        model.effect = effect->name;
        model.slot = slot_name(effect->slot);
      } else {
        model.missing_because = why_missing(name);
      }
    }
    if (seen_in_.emplace(name, out_.files).second) ++model.files;
    if (!effect) return;
    const std::string fault = fault_of(*effect, record, nullptr, where);
    if (!fault.empty() && ++model.refused == 1) model.fault = fault;
  }

  Coverage out_;
  std::map<std::string, ModelCoverage> models_;
  std::set<std::pair<std::string, int>> seen_in_;
};

}  // namespace

Coverage take_coverage(const std::vector<std::filesystem::path>& dyr_files) {
  CoverageTaker taker;
  Problems problems;
  for (const auto& file : dyr_files) try {
      taker.read(file);
    } catch (const InputError& error) {
      problems.add(error);
    }
  problems.raise();
  return taker.end();
}

}  // namespace swingbank::sim::grid
