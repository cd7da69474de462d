#include "validate/report/run_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <tuple>

#include "base/json.hpp"

namespace swingbank::validate::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Reader of one JSON object, which collects missing keys and keys of the wrong type.
class Object {
 public:
  Object(const json& object, std::string where, Problems& problems)
      : object_(object), where_(std::move(where)), problems_(problems) {}

  template <class T>
  void get(const char* key, T& value) {
    const auto at = object_.find(key);
    if (at == object_.end()) return fault(key, "it is missing");
    try {
      value = at->get<T>();
    } catch (const json::exception&) {
      return fault(key, "it has the wrong type");
    }
    if constexpr (std::is_same_v<T, double>)
      if (!std::isfinite(value)) fault(key, "it is not finite");
  }
  void fault(const char* key, const std::string& why) {
    problems_.add(fmt::format("key '{}'", key), where_, why,
                  "write the result again with this version's swingbank train");
  }
  [[nodiscard]] const json& value() const { return object_; }

 private:
  const json& object_;
  std::string where_;
  Problems& problems_;
};

void read_parameters(Object& o, const std::string& where, RunResult& r, Problems& problems) {
  json list;
  o.get("per_parameter", list);
  if (!list.is_array()) return o.fault("per_parameter", "it is not a list");
  for (const auto& item : list) {
    Object p(item, where + " per_parameter", problems);
    ParameterResult score;
    p.get("name", score.name);
    p.get("unit", score.unit);
    p.get("mse", score.mse);
    p.get("variance", score.variance);
    if (item.contains("relative") && item["relative"].is_number())
      score.relative = item["relative"].get<double>();
    if (item.contains("examples")) {
      Object examples(item["examples"], where + " examples", problems);
      examples.get("truth", score.truth);
      examples.get("estimate", score.estimate);
      if (score.truth.size() != score.estimate.size())
        examples.fault("estimate", "it has another length than 'truth'");
    }
    r.parameters.push_back(std::move(score));
  }
}

/// Reads key `curve` of train/run/README.md.
void read_curve(Object& o, const std::string& where, RunResult& r, Problems& problems) {
  if (!o.value().contains("curve")) return;
  if (!o.value()["curve"].is_array()) return o.fault("curve", "it is not a list");
  for (const auto& item : o.value()["curve"]) {
    Object one(item, where + " curve", problems);
    EpochResult& e = r.curve.emplace_back();
    one.get("epoch", e.epoch);
    one.get("validation_loss", e.validation);
  }
}

/// Reads key `posterior` of train/run/README.md: coverage of the intervals on the test rows.
void read_coverage(Object& o, const std::string& where, RunResult& r, Problems& problems) {
  if (!o.value().contains("posterior")) return;
  const json& posterior = o.value()["posterior"];
  if (!posterior.is_object() || !posterior.contains("test")) return o.fault("posterior", "it has no 'test'");
  Object test(posterior["test"], where + " posterior", problems);
  std::int64_t rows = 0;
  test.get("rows", rows);
  for (const auto& [key, nominal] : {std::pair{"coverage_50", 0.5}, std::pair{"coverage_90", 0.9}}) {
    r.coverage.push_back({nominal, 0.0, static_cast<double>(rows)});
    test.get(key, r.coverage.back().observed);
  }
}

/// Reads key `several` of train/run/README.md.
void read_several(Object& o, const std::string& where, RunResult& r, Problems& problems) {
  if (!o.value().contains("several")) return;
  if (!o.value()["several"].is_array()) return o.fault("several", "it is not a list");
  for (const auto& item : o.value()["several"]) {
    Object one(item, where + " several", problems);
    SeveralRecords s;
    one.get("at_most", s.at_most);
    one.get("plants", s.plants);
    one.get("records", s.records);
    one.get("mse_of_mean", s.mse_of_mean);
    if (item.contains("mse_of_product") && item["mse_of_product"].is_number())
      s.mse_of_product = item["mse_of_product"].get<double>();
    r.several.push_back(s);
  }
}

RunResult read_result(const fs::path& file, Problems& problems) {
  RunResult r;
  r.file = file;
  std::ifstream in(file);
  const json parsed = json::parse(in, nullptr, false);
  if (!parsed.is_object()) {
    problems.add("not a JSON object", file.string(), "the file is damaged or is not a result",
                 "remove it or make the run again");
    return r;
  }
  Object o(parsed, file.string(), problems);
  o.get("table", r.table);
  if (parsed.contains("title")) o.get("title", r.title);
  o.get("network", r.network);
  o.get("preset", r.preset);
  o.get("seed", r.seed);
  o.get("noise", r.noise);
  if (parsed.contains("generator") && !parsed["generator"].is_null()) o.get("generator", r.generator);
  if (parsed.contains("judged") && !parsed["judged"].is_null()) o.get("judged", r.judged);
  json dataset = json::object();
  o.get("dataset", dataset);
  Object d(dataset, file.string() + " dataset", problems);
  d.get("name", r.dataset);
  d.get("hash", r.dataset_hash);
  d.get("config_hash", r.config_hash);
  d.get("rows", r.rows);
  o.get("train_rows", r.train_rows);
  o.get("test_rows", r.test_rows);
  o.get("epochs", r.epochs);
  o.get("best_epoch", r.best_epoch);
  o.get("seconds", r.seconds);
  o.get("seconds_per_epoch", r.seconds_per_epoch);
  o.get("mse", r.mse);
  o.get("mse_varied_only", r.mse_varied_only);
  o.get("baseline_mse", r.baseline_mse);
  o.get("ratio", r.ratio);
  if (parsed.contains("H_ratio") && parsed["H_ratio"].is_null())
    r.H_ratio = std::numeric_limits<double>::quiet_NaN();  // H is constant in that dataset
  else
    o.get("H_ratio", r.H_ratio);
  if (parsed.contains("rows_mse")) {
    Object rows(parsed["rows_mse"], file.string() + " rows_mse", problems);
    RowScatter& scatter = r.scatter.emplace();
    rows.get("median", scatter.median);
    rows.get("worst", scatter.worst);
    rows.get("failed", scatter.failed);
  }
  r.seen = std::numeric_limits<double>::quiet_NaN();
  if (parsed.contains("seen_mse") && !parsed["seen_mse"].is_null()) o.get("seen_mse", r.seen);
  o.get("shuffled_labels", r.shuffled);
  o.get("threads", r.threads);
  r.core_seconds = r.seconds * r.threads;  // upper bound for results without processor_seconds
  if (parsed.contains("processor_seconds")) o.get("processor_seconds", r.core_seconds);
  o.get("software", r.software);
  o.get("blas", r.blas);
  if (parsed.contains("train_share")) o.get("train_share", r.share);
  read_curve(o, file.string(), r, problems);
  read_coverage(o, file.string(), r, problems);
  read_several(o, file.string(), r, problems);
  read_parameters(o, file.string(), r, problems);
  return r;
}

auto identity(const RunResult& r) {
  return std::tie(r.table, r.network, r.preset, r.dataset_hash, r.rows, r.seed, r.noise, r.generator,
                  r.judged, r.shuffled, r.share);
}

}  // namespace

std::vector<RunResult> read_results(const std::vector<fs::path>& folders) {
  std::vector<RunResult> results;
  Problems problems;
  for (const auto& folder : folders) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
    if (error || files.empty())
      problems.add("no results", folder.string(), error ? error.message() : "there is no .json file in it",
                   "give a folder that swingbank train or cross-validate wrote");
    std::ranges::sort(files);
    for (const auto& file : files) results.push_back(read_result(file, problems));
  }
  problems.raise();
  for (std::size_t i = 0; i < results.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (identity(results[i]) == identity(results[j]))
        problems.add("a second result of the same run", results[i].file.string(),
                     "it is also in " + results[j].file.string(), "give one of the folders");
  problems.raise();
  return results;
}

}  // namespace swingbank::validate::report
