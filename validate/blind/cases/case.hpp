#pragma once
// Blind cases: records of one plant in which an effect is hidden that its model file lacks, made by a path
// independent of the one that will judge them - IDA on the unreduced grid, sampled at another rate than any
// of our integrators, switchings off the sampling grid. The files are described in docs/blind-test.md.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json.hpp"
#include "sim/network/event.hpp"
#include "validate/blind/cases/config.hpp"
#include "validate/plant/plant_model.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::blind::cases {

/// What is asked of one case; everything else is drawn from (seed, index).
struct BlindSpec {
  std::uint64_t seed = 0;
  std::uint64_t index = 0;                 ///< of the case within its run
  std::vector<const BlindKind*> hidden{};  ///< none: only parameters are wrong; two: both at once
  double size = 0;                         ///< wanted, in detection limits; 0: drawn
};

struct BlindEvent {
  std::string text;                ///< what happened, with units
  sim::network::Event event;       ///< indices of the grid it was drawn for
  std::vector<double> switchings;  ///< instants within the record [s]
  double seconds = 0;              ///< simulated and, but for a late beginning, recorded
};

/// One hidden effect at the size it was given.
struct BlindTruth {
  const BlindKind* kind = nullptr;
  double scale = 0;   ///< 0 neutral, 1 full
  double wanted = 0;  ///< size asked for [noise]
  double left = 0;  ///< size reached: what is left of it in P and Q of all events after a linear refit of the
                    ///< machine's parameters and the switching instants [noise]
  double visible = 0;  ///< before that refit [noise]
};

struct BlindCase {
  BlindSpec spec;
  int attempts = 0;            ///< draws until every event was stable
  std::string maker = "grid";  ///< or "second": tests/blind
  std::string grid_name, plant_name;
  sim::Conventions conventions;
  sim::plant::Plant truth,
      model;  ///< with the hidden effects and right parameters; without, and 10-20 % wrong
  std::optional<sim::plant::Plant> other;  ///< the unit recorded with it, whose model is right
  std::vector<BlindEvent> events;
  std::vector<record::Record> records;  ///< with noise, one per event
  std::vector<BlindTruth> hidden;
  double noise = 0;                     ///< of the machine's MVA [-]
  double voltage_noise = 0;             ///< of V [pu] and theta [rad]
  std::vector<std::string> conditions;  ///< what of [conditions] was drawn, in words
  bool pmu_filter = false, channels = false, controlled = false;
};

/// Draws and simulates one case. Throws InputError where no stable one is found in 60 draws.
BlindCase make_blind_case(const BlindConfig& config, const BlindSpec& spec);

/// Writes model.toml and event1.csv ... into `folder`, which appears complete or not at all, and the truth
/// into the file `truth`, before.
void write_blind_case(const BlindCase& made, const BlindConfig& config, const std::string& name,
                      const std::filesystem::path& folder, const std::filesystem::path& truth);

/// A record as CSV, with the columns of validate/record/README.md.
std::string record_csv(const record::Record& record);

}  // namespace swingbank::validate::blind::cases
