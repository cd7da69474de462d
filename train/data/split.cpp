#include "train/data/split.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "base/problem.hpp"
#include "train/data/random.hpp"

namespace swingbank::train::data {
namespace {

/// Union-find of rows.
class Groups {
 public:
  explicit Groups(std::size_t rows) : above_(rows) {
    std::iota(above_.begin(), above_.end(), std::size_t{0});
  }
  std::size_t first_of(std::size_t i) {
    while (above_[i] != i) i = above_[i] = above_[above_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = first_of(a);
    b = first_of(b);
    above_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> above_;
};

std::vector<double> parameters_of(const Labels& labels, std::uint64_t row) {
  const auto first = labels.values.begin() + static_cast<std::ptrdiff_t>(row * labels.parameters);
  return {first, first + static_cast<std::ptrdiff_t>(labels.parameters)};
}

/// Returns groups of rows that share a databank sample or an event, in order of first appearance.
std::vector<std::vector<std::uint64_t>> points_of(const Labels& labels,
                                                  const std::vector<std::uint64_t>& rows) {
  std::map<std::vector<double>, std::size_t> point;
  std::map<std::uint64_t, std::size_t> event;
  Groups groups(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    groups.join(i, point.try_emplace(parameters_of(labels, rows[i]), i).first->second);
    groups.join(i, event.try_emplace(labels.sample_id[rows[i]], i).first->second);
  }
  std::map<std::size_t, std::vector<std::uint64_t>> found;  // by first row
  for (std::size_t i = 0; i < rows.size(); ++i) found[groups.first_of(i)].push_back(rows[i]);
  std::vector<std::vector<std::uint64_t>> points;
  for (auto& [first, members] : found) points.push_back(std::move(members));
  return points;
}

/// Appends the rows of the training dataset to the training rows, except those with the parameters of a
/// validation or test row; those of generators set aside become recalibration rows.
void add_training_rows(const Labels& labels, const std::set<std::int32_t>& left_out, RowSplit& split) {
  std::vector<std::uint64_t> more;
  for (std::uint64_t row = labels.judged; row < labels.rows; ++row) {
    if (left_out.contains(labels.generator[row])) continue;
    const bool aside = std::ranges::find(split.set_aside, labels.generator[row]) != split.set_aside.end();
    (aside ? split.calibration : more).push_back(row);
  }
  leave_out(more, labels, held_out(labels, split));
  split.train.insert(split.train.end(), more.begin(), more.end());
}

std::vector<std::uint64_t> rows_of(const std::vector<std::vector<std::uint64_t>>& points, std::size_t begin,
                                   std::size_t end) {
  std::vector<std::uint64_t> rows;
  for (std::size_t i = begin; i < end; ++i) rows.insert(rows.end(), points[i].begin(), points[i].end());
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::size_t share(std::size_t count, double part) {
  return static_cast<std::size_t>(std::lround(part * static_cast<double>(count)));
}

void require_rows(const RowSplit& split, std::size_t points) {
  if (split.train.empty() || split.validation.empty() || split.test.empty())
    throw InputError({fmt::format("only {} databank samples", points), "dataset",
                      "training, validation and test each need some", "generate more draws"});
}

std::vector<std::uint64_t> own_rows(const Labels& labels) {
  std::vector<std::uint64_t> all(labels.judged);
  std::iota(all.begin(), all.end(), std::uint64_t{0});
  return all;
}

/// Splits groups of rows: 60 % training, 20 % validation, 20 % test.
RowSplit split_groups(const Labels& labels, std::vector<std::vector<std::uint64_t>> points,
                      std::uint64_t seed) {
  shuffle(points, key(seed, Purpose::split));
  const std::size_t train = share(points.size(), 0.6), validation = share(points.size(), 0.8);
  RowSplit split{rows_of(points, 0, train), rows_of(points, train, validation),
                 rows_of(points, validation, points.size())};
  require_rows(split, points.size());
  add_training_rows(labels, {}, split);
  return split;
}

}  // namespace

ParameterSets held_out(const Labels& labels, const RowSplit& split) {
  ParameterSets sets;
  for (const auto* part : {&split.validation, &split.test})
    for (const std::uint64_t row : *part) sets.insert(parameters_of(labels, row));
  return sets;
}

void leave_out(std::vector<std::uint64_t>& rows, const Labels& labels, const ParameterSets& sets) {
  std::erase_if(rows, [&](std::uint64_t row) { return sets.contains(parameters_of(labels, row)); });
}

RowSplit split_by_point(const Labels& labels, std::uint64_t seed) {
  return split_groups(labels, points_of(labels, own_rows(labels)), seed);
}

RowSplit split_by_row(const Labels& labels, std::uint64_t seed) {
  std::vector<std::vector<std::uint64_t>> rows;
  for (const std::uint64_t row : own_rows(labels)) rows.push_back({row});
  return split_groups(labels, std::move(rows), seed);
}

RowSplit leave_one_out(const Labels& labels, const LeaveOneOut& plan) {
  RowSplit split;
  const std::int32_t generator = plan.generator, test = plan.judged.value_or(generator);
  for (const std::int32_t other : generators(labels))
    if (other != generator && other != test) split.set_aside.push_back(other);
  shuffle(split.set_aside, key(plan.seed, Purpose::set_aside, static_cast<std::uint64_t>(generator)));
  split.set_aside.resize(std::min(plan.set_aside, split.set_aside.size()));
  const std::set<std::int32_t> aside(split.set_aside.begin(), split.set_aside.end());
  std::vector<std::uint64_t> others;
  for (std::uint64_t row = 0; row < labels.judged; ++row) {
    const std::int32_t of = labels.generator[row];
    if (of == test)
      split.test.push_back(row);
    else if (of != generator)
      (aside.contains(of) ? split.calibration : others).push_back(row);
  }
  if (split.test.empty())
    throw InputError({fmt::format("generator {} has no rows", test), plan.judged ? "--judge-on" : "--fold",
                      fmt::format("the dataset has generators {}", fmt::join(generators(labels), ", ")),
                      "choose one of these, or all"});
  auto points = points_of(labels, others);
  shuffle(points, key(plan.seed, Purpose::split, static_cast<std::uint64_t>(generator)));
  const std::size_t validation = share(points.size(), plan.validation_share);
  split.validation = rows_of(points, 0, validation);
  split.train = rows_of(points, validation, points.size());
  require_rows(split, points.size());
  add_training_rows(labels, {generator, test}, split);
  return split;
}

RowSplit split_across(const Labels& labels, double validation_share, std::uint64_t seed) {
  RowSplit split;
  split.test = own_rows(labels);
  std::vector<std::uint64_t> others(labels.rows - labels.judged);
  std::iota(others.begin(), others.end(), labels.judged);
  leave_out(others, labels, held_out(labels, split));
  auto points = points_of(labels, others);
  shuffle(points, key(seed, Purpose::split));
  const std::size_t validation = share(points.size(), validation_share);
  split.validation = rows_of(points, 0, validation);
  split.train = rows_of(points, validation, points.size());
  require_rows(split, points.size());
  return split;
}

std::vector<std::uint64_t> some_of(std::span<const std::uint64_t> rows, std::size_t most) {
  std::vector<std::uint64_t> some(rows.begin(), rows.end());
  if (some.size() <= most) return some;
  shuffle(some, key(0, Purpose::selection));
  some.resize(most);
  std::ranges::sort(some);
  return some;
}

void keep_share(RowSplit& split, const Labels& labels, double part) {
  const auto more = std::ranges::lower_bound(split.train, labels.judged);
  const auto own = static_cast<std::size_t>(more - split.train.begin());
  std::vector<std::uint64_t> kept(split.train.begin(),
                                  split.train.begin() + static_cast<std::ptrdiff_t>(share(own, part)));
  kept.insert(kept.end(), more, more + static_cast<std::ptrdiff_t>(share(split.train.size() - own, part)));
  if (kept.empty())
    throw InputError({fmt::format("no training rows in a share of {}", part), "--train-share",
                      fmt::format("the split has {} training rows", split.train.size()),
                      "give a larger share"});
  split.train = std::move(kept);
}

std::vector<std::int32_t> generators(const Labels& labels) {
  const std::set<std::int32_t> distinct(labels.generator.begin(), labels.generator.end());
  return {distinct.begin(), distinct.end()};
}

}  // namespace swingbank::train::data
