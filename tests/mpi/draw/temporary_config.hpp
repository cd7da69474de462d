#pragma once
// Dataset configs for tests.
#include "mpi/draw/dataset_config.hpp"

namespace swingbank::test {

/// The thesis's GENROU parameter box without a network, sufficient for a databank.
inline mpi::draw::DatasetConfig genrou_box() {
  mpi::draw::DatasetConfig c;
  c.file = "genrou.toml";
  c.model = "GENROU";
  const std::pair<const char*, std::pair<double, double>> box[] = {
      {"Tdop", {2, 10}},    {"Tdopp", {0.06667, 0.2}},
      {"Tqop", {0.5, 1.2}}, {"Tqopp", {0.1, 0.2}},
      {"H", {1, 10}},       {"D", {0, 3}},
      {"Xd", {0.8, 2.5}},   {"Xq", {0.4, 2.4}},
      {"Xdp", {0.8, 2.5}},  {"Xqp", {0.4, 2.4}},
      {"Xdpp", {0.3, 0.3}}, {"Xl", {0.01, 0.25}},
      {"S10", {0.001, 1}},  {"S12", {0.01, 5}}};
  for (const auto& [name, range] : box)
    c.box.push_back({c.effect().parameter_index(name), range.first, range.second});
  c.generators = {30};
  c.databank.distance = 0.7;
  c.record.channels = {"P"};
  return c;
}

}  // namespace swingbank::test
