#include "train/run/detail/several.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "base/json.hpp"

namespace swingbank::train::run {
namespace {
using nlohmann::json;
constexpr std::size_t kMinRecords = 3;
constexpr std::array<std::size_t, 3> kRecords = {1, 3, 12};  // largest numbers of combined records
}  // namespace

std::vector<std::vector<std::size_t>> plants_of(const data::Labels& labels,
                                                std::span<const std::uint64_t> rows) {
  std::map<std::vector<double>, std::vector<std::size_t>> by_parameters;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto first = labels.values.begin() + static_cast<std::ptrdiff_t>(rows[i] * labels.parameters);
    std::vector<double> plant(first, first + static_cast<std::ptrdiff_t>(labels.parameters));
    plant.push_back(labels.generator[rows[i]]);
    by_parameters[std::move(plant)].push_back(i);
  }
  std::vector<std::vector<std::size_t>> plants;
  for (auto& [parameters, own] : by_parameters)
    if (own.size() >= kMinRecords) plants.push_back(std::move(own));
  return plants;
}

json several_json(const data::Labels& labels, std::span<const std::uint64_t> rows,
                  std::span<const double> estimates, const FromSeveral& product) {
  const auto plants = plants_of(labels, rows);
  if (plants.empty()) return {};
  const std::size_t p = labels.parameters;
  const FromSeveral mean = [&](std::span<const std::size_t> own) {
    std::vector<double> all(p, 0.0);
    for (const std::size_t i : own)
      for (std::size_t k = 0; k < p; ++k) all[k] += estimates[i * p + k] / static_cast<double>(own.size());
    return all;
  };
  json list = json::array();
  for (const std::size_t most : kRecords) {
    double records = 0.0;
    const auto squared_error = [&](const FromSeveral& from) {
      double sum = 0.0;
      for (const auto& plant : plants) {
        const std::span own(plant.data(), std::min(most, plant.size()));
        const std::vector<double> found = from(own);
        for (std::size_t k = 0; k < p; ++k) {
          const double e = found[k] - labels.values[rows[own.front()] * p + k];
          sum += e * e;
        }
      }
      return sum / static_cast<double>(plants.size() * p);
    };
    for (const auto& plant : plants) records += static_cast<double>(std::min(most, plant.size()));
    list.push_back({{"at_most", most},
                    {"records", records / static_cast<double>(plants.size())},
                    {"plants", plants.size()},
                    {"mse_of_mean", squared_error(mean)},
                    {"mse_of_product", product ? json(squared_error(product)) : json()}});
  }
  return list;
}

}  // namespace swingbank::train::run
