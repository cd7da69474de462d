#pragma once
// Blind cases: records of a plant with an effect that its model file lacks. They are simulated independently
// of the diagnosis: by IDA on the unreduced grid, at a sampling rate that no other integrator here uses, and
// with switching times between the samples. docs/reference/blind-test.md describes the files.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "research/blind/cases/config.hpp"
#include "sim/network/event.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::research::blind::cases {

/// Specification of one case. Everything else is drawn at random from (seed, index).
struct BlindSpec {
  std::uint64_t seed = 0;
  std::uint64_t index = 0;                 ///< number of the case in its run, from 1
  std::vector<const BlindKind*> hidden{};  ///< hidden kinds, at most two; empty: only parameters are wrong
  double size = 0;                         ///< requested size [detection limits]; 0: drawn
};

/// Event of a case.
struct BlindEvent {
  std::string text;                ///< description with units
  sim::network::Event event;       ///< event; its indices are those of the grid
  std::vector<double> switchings;  ///< switching times within the record [s]
  double seconds = 0;              ///< simulated duration [s]; the record may start later
};

/// Hidden effect with its size.
struct BlindTruth {
  const BlindKind* kind = nullptr;
  double scale = 0;   ///< position on the path; 0: null value, 1: full value
  double wanted = 0;  ///< requested size [noise]
  double left = 0;    ///< actual size: norm of the residual of P and Q in all events, after a linear refit of
                      ///< the model's parameters, the switching times and the initial states [noise]
  double visible = 0;  ///< size before that refit [noise]
};

/// Case with its truth.
struct BlindCase {
  BlindSpec spec;
  int attempts = 0;            ///< number of draws until every event was stable
  std::string maker = "grid";  ///< simulator: "grid" is this one, "second" that of tests/blind
  std::string grid_name, plant_name;
  sim::Conventions conventions;
  sim::plant::Plant truth,
      model;  ///< truth: with hidden effects; model: without them, with wrong machine parameters
  std::optional<sim::plant::Plant> other;  ///< second unit in the record, whose model is correct
  std::vector<BlindEvent> events;
  std::vector<validate::record::Record> records;  ///< with noise, one per event
  std::vector<BlindTruth> hidden;
  double noise = 0;                     ///< standard deviation as a share of the machine's MVA [-]
  double voltage_noise = 0;             ///< standard deviation of V [pu] and theta [rad]
  std::vector<std::string> conditions;  ///< names of the [conditions] that were drawn
  bool pmu_filter = false, channels = false, controlled = false;
};

/// Draws and simulates one case. Throws InputError if none of 60 draws is suitable.
BlindCase make_blind_case(const BlindConfig& config, const BlindSpec& spec);

/// Writes the truth to the file `truth`, then model.toml and event1.csv ... to `folder`. The folder gets its
/// name only when it is complete.
void write_blind_case(const BlindCase& made, const BlindConfig& config, const std::string& name,
                      const std::filesystem::path& folder, const std::filesystem::path& truth);

/// Returns a record as CSV with the columns of validate/record/README.md.
std::string record_csv(const validate::record::Record& record);

}  // namespace swingbank::research::blind::cases
