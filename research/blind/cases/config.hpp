#pragma once
// Config of a blind test (configs/blind/*.toml): grids, noise, recording conditions and kinds of hidden
// effect. Limits and thresholds are fixed before the seed of a scored run is drawn.
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace swingbank::research::blind::cases {

/// Path of one parameter from its null value (scale 0) to its full value (scale 1).
struct BlindPath {
  std::string target;     ///< "machine", "conventions" or the name of an effect
  std::string parameter;  ///< name of a parameter of the target
  double null_value, full;
};

/// Kind of hidden effect, with the path of parameters that scales its size.
struct BlindKind {
  std::string name;
  std::string side;                         ///< subsystem: mechanical, excitation, machine, measurement, none
  bool listed = true;                       ///< whether a hypothesis covers it; else unlisted disturbance
  bool drawn = true;                        ///< whether it may be drawn; otherwise only requested by name
  bool value = false;                       ///< whether only values of the model are wrong, nothing missing
  std::vector<std::string> base;            ///< controls in the model: "EFFECT[:PARAM=VALUE,...]"
  std::vector<std::string> hidden;          ///< effects that the model lacks, in the same form
  std::vector<std::string> accepted_names;  ///< names that count as right; all needed if `value`
  std::vector<BlindPath> path;
  bool logarithmic = false;  ///< whether the scale is linear in the parameters' logarithms
  /// Returns whether the effect is an instrument error.
  [[nodiscard]] bool of_instrument() const { return side == "measurement"; }
  double limit = 0;  ///< detection limit (docs/reference/blind-test.md) [noise]
};

/// Grid with its PSS/E files.
struct BlindGrid {
  std::filesystem::path raw, dyr;
  std::vector<std::int64_t> buses;  ///< buses of the plants that may be recorded
};

/// Field conditions that differ from a clean record of a quiet grid ([conditions];
/// docs/reference/blind-test.md). They are drawn for each case. A share of 0 or an empty list consumes no
/// random number, and the value in [record] applies.
struct BlindConditions {
  std::vector<double> rates;           ///< reporting rates [1/s]
  std::vector<double> voltage_noise;   ///< as BlindConfig::voltage_noise
  double class_m_share = 0;            ///< share of class M among filtered records at `class_m_rates`
  std::vector<double> class_m_rates;   ///< rates for which the standard defines a class M filter [1/s]
  double short_share = 0, lead = 0.2;  ///< share of records that begin `lead` [s] before their event
  double ambient_share = 0;            ///< share of cases with independent random variation of every load
  std::pair<double, double> ambient{0, 0};  ///< range of its RMS, as a share of the load's power
  double drift_share = 0;                   ///< share of cases with a drift of all loads
  std::pair<double, double> drift{0, 0};    ///< range of its rate, up or down: share of the power per minute
  double wander_share = 0;                  ///< share of cases with a varying angle reference
  std::pair<double, double> wander{0, 0};   ///< range of its amplitude [rad]
  double long_share = 0;                    ///< share of cases whose first record is three times as long
  double dip_share = 0;          ///< share of cases whose last event is a frequency dip without switching
  double transformer_share = 0;  ///< share of cases recorded behind a transformer, which the model contains
  double second_unit_share = 0;  ///< share of cases recorded together with another unit of known model
  std::vector<std::string> machines;  ///< machine effects; one replaces the machine of the .dyr file
  std::vector<std::string> controls;  ///< controls in every case's model: "EFFECT[:PARAM=VALUE,...]"
  std::vector<std::string> exciters, governors;  ///< possible controls in the model of a rotating machine
};

struct BlindConfig {
  std::vector<BlindGrid> grids;
  std::vector<BlindKind> kinds;
  std::vector<double> noise;  ///< noise levels as shares of the machine's MVA, one drawn per case [-]
  double voltage_noise = 1;   ///< noise of V [pu] and theta [rad] as a multiple of `noise`
  double speed_noise = 0;     ///< noise of the rotor speed [pu]
  double seconds = 15, rate = 60, fine_rate = 960;
  int faults = 4, frequency_events = 1;
  std::pair<double, double> wrong{0.1, 0.2};  ///< range of relative errors of the model's machine parameters
  std::pair<double, double> size{1.0, 10.0};  ///< range of drawn sizes in detection limits
  double relative_range = 0.1;  ///< largest relative deviation of true parameters from the files
  BlindConditions conditions;
  double filter_share = 0.5, channels_share = 0.5, controlled_share = 0.5;
  std::uint64_t hash = 0;  ///< XXH64 of the file

  /// Returns the kind of that name; nullptr if there is none.
  [[nodiscard]] const BlindKind* kind(const std::string& name) const;
};

/// Reads a config. Throws InputError with every error of the file, including unknown effects and parameters.
BlindConfig load_blind_config(const std::filesystem::path& file);

}  // namespace swingbank::research::blind::cases
