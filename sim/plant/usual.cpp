#include "sim/plant/usual.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace swingbank::sim::plant {
namespace {

std::string with_unit(std::string number, std::string_view unit) {
  if (unit != "-" && unit != "code" && !unit.empty()) number += " " + std::string(unit);
  return number;
}
/// Whether a value means "none": 99, 999, -9999, ... are common codes for "no limit" or "no such block".
bool means_none(double value) {
  double nines = 99.0;
  for (int digits = 2; digits < 8; ++digits, nines = 10 * nines + 9)
    if (std::abs(value) == nines) return true;
  return false;
}
const Parameter& record_of(const Effect& effect, int parameter) {
  return effect.parameters[static_cast<std::size_t>(parameter)];
}

}  // namespace

std::vector<int> unusual(const Block& block) {
  std::vector<int> list;
  for (std::size_t i = 0; i < block.p.size(); ++i)
    if (const Parameter& p = block.effect->parameters[i];
        !(block.p[i] >= p.low && block.p[i] <= p.high) && !means_none(block.p[i]))
      list.push_back(static_cast<int>(i));
  return list;
}

std::string value_text(const Block& block, int parameter) {
  const Parameter& p = record_of(*block.effect, parameter);
  return with_unit(fmt::format("{} = {:g}", p.name, block.p[static_cast<std::size_t>(parameter)]), p.unit);
}

std::string usual_text(const Effect& effect, int parameter) {
  const Parameter& p = record_of(effect, parameter);
  return with_unit(fmt::format("usual range of {}: {:g} to {:g}", effect.name, p.low, p.high), p.unit);
}

std::vector<std::string> unusual_texts(const Block& block, const std::string& where) {
  std::vector<std::string> list;
  for (const int i : unusual(block))
    list.push_back(fmt::format("{}: {} ({})", where, value_text(block, i), usual_text(*block.effect, i)));
  return list;
}

SearchRange search_range(const Parameter& record, double value) {
  const double width = record.high - record.low;
  SearchRange range{record.low, record.high};
  if (value > range.high) range.high = std::max(value + width, record.high);
  if (value < range.low) range.low = value - width;
  if (record.low >= 0 && value >= 0) range.low = std::max(range.low, 0.0);
  if (record.high <= 0 && value <= 0) range.high = std::min(range.high, 0.0);
  return range;
}

}  // namespace swingbank::sim::plant
