#include "validate/user_model_search/regression.hpp"

#include <algorithm>
#include <cmath>

namespace swingbank::validate::user_model_search {

UserModelRegression::UserModelRegression(const std::vector<UserModelTrace>& traces) : traces_(traces) {
  Eigen::Index knots = 0;
  for (const auto& e : traces) knots += static_cast<Eigen::Index>(e.knots.size());
  target_.resize(knots);
  weight_.setZero(knots);
  Eigen::Index at = 0;
  for (const auto& e : traces) {
    std::vector<Weight> hats;
    std::vector<double> sum(e.knots.size(), 0.0);
    for (std::size_t s = 0; s < e.t.size(); ++s) {
      if (e.t[s] < e.knots.front() || e.t[s] > e.knots.back()) continue;
      const auto above = std::ranges::upper_bound(e.knots.begin() + 1, e.knots.end() - 1, e.t[s]);
      const auto k = static_cast<std::size_t>(above - e.knots.begin()) - 1;
      const double share = (e.t[s] - e.knots[k]) / (e.knots[k + 1] - e.knots[k]);
      for (const auto& [knot, part] : {std::pair{k, 1 - share}, std::pair{k + 1, share}}) {
        hats.push_back({static_cast<int>(knot), static_cast<int>(s), part});
        sum[knot] += part;
      }
    }
    for (auto& h : hats) h.share /= sum[static_cast<std::size_t>(h.knot)];
    hats_.push_back(std::move(hats));
    // The last knots hardly influence the response, so their values are not determined.
    constexpr std::size_t kUnknown = 3;
    for (std::size_t k = 0; k < e.knots.size(); ++k, ++at) {
      target_[at] = e.input[k];
      const double left = k == 0 ? 0 : e.knots[k] - e.knots[k - 1];
      const double right = k + 1 == e.knots.size() ? 0 : e.knots[k + 1] - e.knots[k];
      if (k + kUnknown < e.knots.size()) weight_[at] = std::sqrt((left + right) / 2);
    }
  }
  total_ = weight_.cwiseProduct(target_).squaredNorm();
  // Neighbouring knots are correlated, so only half of them count as independent.
  count_ = static_cast<double>((weight_.array() > 0).count()) / 2;
}

Eigen::VectorXd UserModelRegression::at_knots(const TimeSeries& time_series) const {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(target_.size());
  Eigen::Index first = 0;
  for (std::size_t e = 0; e < traces_.size(); ++e) {
    for (const Weight& w : hats_[e])
      column[first + w.knot] += w.share * time_series[e][static_cast<std::size_t>(w.sample)];
    first += static_cast<Eigen::Index>(traces_[e].knots.size());
  }
  return column;
}

UserModelRegression::Result UserModelRegression::fit(const std::vector<Eigen::VectorXd>& columns,
                                                     int numbers) const {
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd normal(n, n);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd w = columns[static_cast<std::size_t>(i)].cwiseProduct(weight_.cwiseAbs2());
    for (Eigen::Index j = 0; j < n; ++j) normal(i, j) = w.dot(columns[static_cast<std::size_t>(j)]);
    right[i] = w.dot(target_);
  }
  Result a;
  a.time_series = Eigen::VectorXd::Zero(target_.size());
  a.factors = Eigen::VectorXd::Zero(n);
  if (normal.diagonal().minCoeff() > 1e-18 * static_cast<double>(target_.size()))
    a.factors = normal.ldlt().solve(right);
  if (!a.factors.allFinite()) a.factors.setZero();
  for (Eigen::Index i = 0; i < n; ++i) a.time_series += a.factors[i] * columns[static_cast<std::size_t>(i)];
  const double rest = weight_.cwiseProduct(target_ - a.time_series).squaredNorm();
  a.explained = total_ > 0 ? 1 - rest / total_ : 0;
  a.score = count_ * std::log(std::max(1e-6, 1 - a.explained)) +
            static_cast<double>(n + numbers) * std::log(count_);
  return a;
}

std::vector<std::vector<double>> UserModelRegression::by_event(const Eigen::VectorXd& all) const {
  std::vector<std::vector<double>> events;
  Eigen::Index at = 0;
  for (const auto& e : traces_) {
    const auto n = static_cast<Eigen::Index>(e.knots.size());
    events.emplace_back(all.data() + at, all.data() + at + n);
    at += n;
  }
  return events;
}

}  // namespace swingbank::validate::user_model_search
