#pragma once
// Results of Y. Wu, "Model Parameter Calibration in Power Systems", University of Vermont, 2020, chapter 4,
// for comparison. Mean squared error over the parameters in raw units, on test data.
#include <array>
#include <string_view>

namespace swingbank::validate::report {

/// Networks of the thesis.
inline constexpr std::array<std::string_view, 3> kThesisNetworks = {"cnn", "lstm", "gru"};

struct ThesisTable {
  std::string_view number, title, machine;
};
inline constexpr std::array<ThesisTable, 3> kThesisTables = {{
    {"IV", "IEEE 14-bus, GENROU at one bus", "GENROU"},
    {"V", "IEEE 39-bus, all GENCLS, one generator left out", "GENCLS"},
    {"VI", "IEEE 39-bus, all GENROU, one generator left out", "GENROU"},
}};

/// Table entry. `generator` is the bus of the generator left out; 0: none (Table IV).
struct ThesisCell {
  std::string_view table, network;
  int generator;
  double mse;
  double seconds_per_epoch;  ///< 0: not given
};
inline constexpr std::array<ThesisCell, 23> kThesisCells = {{
    {"IV", "cnn", 0, 0.017, 525}, {"IV", "lstm", 0, 0.026, 1915}, {"IV", "gru", 0, 0.0079, 1789},
    {"V", "cnn", 30, 0.008, 0},   {"V", "cnn", 31, 0.02, 0},      {"V", "cnn", 32, 0.008, 0},
    {"V", "cnn", 33, 0.007, 0},   {"V", "cnn", 34, 0.0098, 0},    {"V", "cnn", 35, 0.006, 0},
    {"V", "cnn", 36, 0.02, 0},    {"V", "cnn", 37, 0.008, 0},     {"V", "cnn", 38, 0.009, 0},
    {"V", "cnn", 39, 0.43, 0},    {"VI", "cnn", 30, 0.11, 0},     {"VI", "cnn", 31, 0.16, 0},
    {"VI", "cnn", 32, 0.11, 0},   {"VI", "cnn", 33, 0.11, 0},     {"VI", "cnn", 34, 0.13, 0},
    {"VI", "cnn", 35, 0.55, 0},   {"VI", "cnn", 36, 0.12, 0},     {"VI", "cnn", 37, 0.11, 0},
    {"VI", "cnn", 38, 0.11, 0},   {"VI", "cnn", 39, 0.19, 0},
}};
/// Section 4.1.1: EPRI's PPPD on ten test events of the Table IV data, and the CNN on the same events.
inline constexpr double kThesisPppd = 2.6, kThesisCnnOnPppdEvents = 0.018;
/// Section 4.1: validation loss at which the GRU stopped improving on the data of Table VI.
inline constexpr double kThesisGruTableVI = 0.9;

/// Returns the thesis's entry for the network, otherwise its entry with the lowest MSE for that table and
/// generator; nullptr if there is none.
constexpr const ThesisCell* thesis_cell(std::string_view table, std::string_view network, int generator) {
  const ThesisCell* best = nullptr;
  for (const auto& c : kThesisCells) {
    if (c.table != table || c.generator != generator) continue;
    if (c.network == network) return &c;
    if (!best || c.mse < best->mse) best = &c;
  }
  return best;
}

}  // namespace swingbank::validate::report
