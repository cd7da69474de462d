#pragma once
// What blind cases are drawn from: grids, noise, and the kinds of effect that may be hidden
// (configs/blind/*.toml). The limits and thresholds in it are frozen before a scoring seed is drawn.
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace swingbank::validate::blind::cases {

/// One parameter on the way from neutral (scale 0) to full (scale 1).
struct BlindPath {
  std::string target;     ///< "machine", "conventions" or the name of an effect
  std::string parameter;  ///< of that effect
  double neutral, full;
};

/// A kind of hidden effect and the one-dimensional path of its size.
struct BlindKind {
  std::string name;
  std::string side;                  ///< mechanical, excitation, machine, measurement, none
  bool listed = true;                ///< false: of the private set, which no hypothesis names
  bool drawn = true;                 ///< false: hidden only where it is asked for by name
  bool value = false;                ///< nothing is missing: values that the model has are wrong
  std::vector<std::string> base;     ///< controls the model knows: "EFFECT[:PARAM=VALUE,...]"
  std::vector<std::string> hidden;   ///< what the model lacks, written the same way
  std::vector<std::string> answers;  ///< names a verdict may give it; of values all, as EFFECT.PARAM
  std::vector<BlindPath> path;
  bool logarithmic = false;  ///< scale runs through the logarithm of the parameters
  /// Whether it is an error of the instrument.
  [[nodiscard]] bool of_instrument() const { return side == "measurement"; }
  double limit = 0;  ///< detection limit: size (docs/blind-test.md) from which it is asked for [noise]
};

struct BlindGrid {
  std::filesystem::path raw, dyr;
  std::vector<std::int64_t> buses;  ///< buses whose plants may be the one recorded
};

/// What a case may meet beyond a clean record of a quiet grid ([conditions]; docs/blind-test.md). Each is
/// drawn for each case; a share of 0 and an empty list take no draw, and what [record] says holds.
struct BlindConditions {
  std::vector<double> rates;                ///< reports per second
  std::vector<double> voltage_noise;        ///< as BlindConfig's
  double class_m_share = 0;                 ///< of the filtered records that have a rate of `class_m_rates`
  std::vector<double> class_m_rates;        ///< at which the standard has a filter of class M
  double short_share = 0, lead = 0.2;       ///< records that begin `lead` [s] before their event
  double ambient_share = 0;                 ///< every load moves about its power by itself,
  std::pair<double, double> ambient{0, 0};  ///< rms, as a part of its power
  double drift_share = 0;                   ///< all loads drift,
  std::pair<double, double> drift{0, 0};    ///< a part of their power per minute, up or down
  double wander_share = 0;                  ///< the reference of the angle wanders,
  std::pair<double, double> wander{0, 0};   ///< amplitude [rad]
  double long_share = 0;                    ///< the first event is recorded three times as long
  double dip_share = 0;                     ///< the last event is a dip of frequency without any switching
  double transformer_share = 0;             ///< a known transformer stands before the point that is recorded
  double second_unit_share = 0;             ///< another unit at the bus is recorded with it, its model known
  std::vector<std::string> machines;        ///< effects, one of which takes the place of the file's machine
  std::vector<std::string> controls;        ///< that every case's model knows: "EFFECT[:PARAM=VALUE,...]"
  std::vector<std::string> exciters, governors;  ///< that it may know, beside a machine that rotates
};

struct BlindConfig {
  std::vector<BlindGrid> grids;
  std::vector<BlindKind> kinds;
  std::vector<double> noise;  ///< noise in parts of the machine's MVA; one value is drawn for each case [-]
  double voltage_noise = 1;   ///< noise of V [pu] and theta [rad] as a multiple of it
  double speed_noise = 0;     ///< of the rotor speed [pu]
  double seconds = 15, rate = 60, fine_rate = 960;
  int faults = 4, frequency_events = 1;
  std::pair<double, double> wrong{0.1, 0.2};  ///< shares by which the model's machine parameters are off
  std::pair<double, double> size{1.0, 10.0};  ///< drawn sizes, in detection limits
  double spread = 0.1;                        ///< spread of the true parameters about those of the files
  BlindConditions conditions;
  double filter_share = 0.5, channels_share = 0.5, controlled_share = 0.5;
  std::uint64_t hash = 0;  ///< XXH64 of the file

  /// nullptr if there is none of that name.
  [[nodiscard]] const BlindKind* kind(const std::string& name) const;
};

/// Throws InputError with every fault of the file, unknown effects and parameters included.
BlindConfig load_blind_config(const std::filesystem::path& file);

}  // namespace swingbank::validate::blind::cases
