#include "train/loop/metrics.hpp"

#include <algorithm>

#include "base/median.hpp"
#include "train/data/normalise.hpp"

namespace swingbank::train::loop {

std::optional<double> ParameterScore::relative() const {
  if (variance > 0.0) return mse / variance;
  return std::nullopt;
}

Score score(const ScoreInput& in) {
  const std::size_t count = in.names.size(), rows = in.truth.size() / count;
  Score all;
  std::vector<double> of_row(rows);
  std::size_t varied = 0;
  for (std::size_t p = 0; p < count; ++p) {
    ParameterScore s{in.names[p], in.units[p]};
    double error = 0.0, guess = 0.0;
    data::GroupMoments truth(1);
    for (std::size_t r = 0; r < rows; ++r) {
      const double value = in.truth[r * count + p], e = in.predicted[r * count + p] - value,
                   g = in.training_mean[p] - value;
      error += e * e;
      of_row[r] += e * e / static_cast<double>(count);
      guess += g * g;
      truth.add(0, value);
    }
    s.mse = error / static_cast<double>(rows);
    s.baseline_mse = guess / static_cast<double>(rows);
    const double width = in.high[p] - in.low[p], deviation = truth.deviation(0);
    s.variance = width > 0.0 ? deviation * deviation : 0.0;
    s.box_variance = width * width / 12.0;
    all.mse += s.mse / static_cast<double>(count);
    all.baseline_mse += s.baseline_mse / static_cast<double>(count);
    if (width > 0.0) {
      ++varied;
      all.mse_varied_only += s.mse;
      all.baseline_mse_varied_only += s.baseline_mse;
    }
    if (s.name == "H" && s.baseline_mse > 0.0) all.H_ratio = s.mse / s.baseline_mse;
    all.parameters.push_back(std::move(s));
  }
  if (varied > 0) {
    all.mse_varied_only /= static_cast<double>(varied);
    all.baseline_mse_varied_only /= static_cast<double>(varied);
  }
  all.ratio = all.mse / all.baseline_mse;
  all.median_row = median(of_row);
  all.worst_row = *std::ranges::max_element(of_row);
  all.failed_rows = static_cast<double>(std::ranges::count_if(
                        of_row, [&](double mse) { return !(mse < all.baseline_mse); })) /
                    static_cast<double>(rows);
  return all;
}

}  // namespace swingbank::train::loop
