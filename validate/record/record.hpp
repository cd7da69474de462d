#pragma once
// Record of measurements at one plant's terminal: uniformly sampled, units converted on reading.
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"
#include "validate/record/source.hpp"

namespace swingbank::validate::record {

/// Bases for the conversion of columns to per unit.
struct RecordBase {
  double mva = 100.0;       ///< base of P_pu and Q_pu [MVA]
  double frequency = 60.0;  ///< base of f_pu and omega_pu [Hz]
  double kv = 0.0;          ///< base of voltages in kV, line to line; 0: columns in kV are refused
  /// Field voltage and field current that equal 1 pu of the model (air-gap line), in the record's unit (V, A
  /// or another pu). 0: the record uses the model's pu, and columns in V or A are refused.
  double efd = 0.0, ifd = 0.0;  ///< field voltage and current that equal 1 pu
};

/// Source of a record's angle. An angle integrated from a frequency lacks the step at each switching; a
/// missing angle is stored as zeros.
enum class AngleSource { measured, integrated, none };

/// The tested part of a plant: the whole, or one component whose inputs are the recorded outputs of the
/// others.
enum class Component {
  plant,     ///< inputs V and its angle; P and Q are compared
  exciter,   ///< input V, with Vs, Ifd and other signals that its blocks need; Efd is compared
  governor,  ///< input speed, with Pref; Pm and the gate are compared
  machine,   ///< inputs V, its angle, Efd and Pm; P, Q, speed and Ifd are compared
};
/// Returns the name of a component, "exciter".
std::string_view component_name(Component component);

/// Action of a staged test on the plant. The record's channels do not contain it.
struct StagedEvent {
  /// Kind of a staged event.
  enum class Kind {
    vref_step,       ///< step of the voltage reference by `size` [pu]
    pref_step,       ///< step of the governor's reference by `size` [pu on base.mva of the record]
    efd_step,        ///< step of the field voltage under manual control by `size` [pu]
    open_circuit,    ///< breaker open during the whole record
    load_rejection,  ///< breaker opens at `time`
  };
  Kind kind = Kind::vref_step;                                       ///< kind of the event
  double time = 0, until = std::numeric_limits<double>::infinity();  ///< start and end of the step [s]
  double size = 0;                                                   ///< size of the step, see Kind
  std::string record = {};  ///< file name of the record that it applies to; empty: all
  /// Whether the event disconnects the plant from the grid.
  [[nodiscard]] bool opens_breaker() const { return kind >= Kind::open_circuit; }
  /// Returns whether the event applies to this record, by name or because it applies to all.
  [[nodiscard]] bool applies_to(const Source& source) const {
    return record.empty() || source.is_named(record);
  }
  /// Compares all members.
  friend bool operator==(const StagedEvent&, const StagedEvent&) = default;
};

/// Samples at one terminal. All vectors have the length of `t`; optional channels are empty if not recorded.
struct Record {
  std::string name;                  ///< file name without folder
  std::string sha256;                ///< SHA-256 of the bytes (.cfg, then .dat), or of several files' hashes
  RecordBase base;                   ///< bases of the per-unit values
  std::vector<double> t;             ///< [s], increasing, uniform
  std::vector<double> V, theta;      ///< [pu], [rad] (unwrapped)
  std::vector<double> P, Q;          ///< output of the machine [pu on base.mva]
  std::vector<double> f;             ///< optional: frequency deviation [pu]
  std::vector<double> speed;         ///< optional: rotor speed deviation [pu]
  std::vector<double> Efd, Ifd;      ///< optional [pu]
  std::vector<double> Vs, Vref;      ///< optional: stabiliser output, voltage reference [pu]
  std::vector<double> Pm, Pref;      ///< optional: mechanical power, its reference [pu on base.mva]
  std::vector<double> gate;          ///< optional: opening of gate or valve [pu]
  std::vector<std::string> ignored;  ///< columns of unknown or unneeded quantities

  std::string format = "CSV";      ///< file format
  std::string terminal;            ///< name of the terminal, if the file names it
  std::string start;               ///< time stamp of t = 0 as written, if any
  std::optional<double> epoch;     ///< UTC of t = 0 [s since 1970-01-01], if known
  std::vector<std::string> notes;  ///< changes made on reading that affect the interpretation of results
  /// Angle before unwrapping [rad]; empty if the angle was computed or frames were lost.
  std::vector<double> theta_as_written;
  /// Returns theta_as_written, or `theta` if it is empty.
  [[nodiscard]] const std::vector<double>& written_angle() const {
    return theta_as_written.empty() ? theta : theta_as_written;
  }
  AngleSource angle = AngleSource::measured;  ///< source of theta
  bool per_unit_power = true;              ///< P and Q, or the current, were written in pu; false: in MW or A
  std::vector<std::string> named;          ///< quantities whose column was chosen by ReadOptions::columns
  Component component = Component::plant;  ///< tested part of the plant
  std::vector<StagedEvent> staged;         ///< staged actions during the record
  std::vector<double> switched;  ///< switching times given by the user [s]; empty: found from the signals
  /// Marks samples that are not compared: lost frames, whose voltage is interpolated, and frames in which a
  /// compared channel has no value. Empty: none.
  std::vector<char> lost;

  /// Returns the event that opens the breaker; nullptr if there is none, or if an exciter or a governor is
  /// tested alone.
  [[nodiscard]] const StagedEvent* breaker() const;
  /// Whether the breaker is open during the whole record.
  [[nodiscard]] bool open_circuit() const {
    return breaker() && breaker()->kind == StagedEvent::Kind::open_circuit;
  }
  /// Returns the time of the first staged event other than open_circuit [s]; infinity if there is none.
  [[nodiscard]] double first_staged() const;
  /// Returns the number of samples.
  [[nodiscard]] int samples() const { return static_cast<int>(t.size()); }
  /// Returns the sample interval [s].
  [[nodiscard]] double step() const { return (t.back() - t.front()) / static_cast<double>(t.size() - 1); }
  /// Returns the tolerance of comparisons with sample times [s], for times with 6 decimals. A sample at a
  /// switching time within it has the value before the switching.
  [[nodiscard]] double time_slack() const { return 1e-4 * step(); }
  /// Returns the sampling rate [1/s].
  [[nodiscard]] double rate() const { return 1.0 / step(); }
};

/// Returns the angle relative to nominal frequency [rad], integrated from the record's f, starting at zero.
std::vector<double> angle_of_frequency(const Record& record);
/// Unwraps angles [rad]: adds multiples of 2 pi that bring each value closest to its predecessor. Values that
/// are not finite are left unchanged.
void unwrap(std::vector<double>& angle);

/// Minimum number of samples of a record: fewer do not contain a pre-event window and a response.
constexpr int kMinSamples = 30;
/// Shortest record [s]: no model's response is visible in less.
constexpr double kShortestRecord = 0.1;
/// Longest gap of lost frames that is interpolated [s].
constexpr double kLongestGap = 0.2;

/// Column of the file for each quantity: {"V", "BUS1.VPM [kV]"}. Quantities have the names of the members of
/// Record, and "I" and "phi" for the current (word_of() in detail/columns.hpp). The column is identified by
/// its heading, or by "#3" for the third one. The unit follows in brackets if the file gives none. A leading
/// "-" reverses the sign.
using ColumnMap = std::map<std::string, std::string>;

/// Options of reading a record.
struct ReadOptions {
  std::string terminal{};  ///< terminal to read, if the file contains several
  ColumnMap columns{};     ///< columns chosen by the user; the others are recognised by name
  double from = -std::numeric_limits<double>::infinity();  ///< earlier samples are left out [s]
  double until = std::numeric_limits<double>::infinity();  ///< later samples are left out [s]
  double phasor_rate = 0;  ///< phasors per second computed from waveforms; 0: one per nominal cycle
  bool power = true;       ///< P and Q (or the current) are required; false: they may be empty
  bool part = false;       ///< the file is one of several that are joined to one record
  Component component = Component::plant;  ///< tested part of the plant
  /// Columns that a component's record must have: at least one quantity of each inner list. {"speed", "f"}
  /// means speed or frequency.
  std::vector<std::vector<std::string>> needed = {};
  std::vector<StagedEvent> staged = {};  ///< staged events of all records of the plant
  bool angle = false;  ///< a measured angle is required; false: it may be integrated from f, or be missing
  /// The breaker opens, so the playback needs no angle and a missing angle is not noted; read_staged() sets
  /// this flag.
  bool breaker_opens = false;
};

/// Reads a record from its source. The extension determines the format: .cfg/.dat or .cff COMTRADE, .mat
/// MATLAB, .h5 a run of `swingbank simulate`, .inf (or one of its .out) PSCAD, otherwise text columns
/// (validate/record/README.md lists names, units and dialects). "FILE#TERMINAL" selects one of several
/// terminals; "FILE+FILE" joins the columns of several files of one event. Columns of unknown or unneeded
/// quantities are listed in `ignored`. Repairs (short gaps, repeated stamps, clock adjustments) are listed in
/// `notes`. check_record (validate/check/check.hpp) checks the content. Throws InputError with every fault of
/// the file and its lines or bytes. Faults are missing or repeated columns, columns without unit, lines of
/// unequal length and too few samples. Further faults are values that are not finite or missing for longer
/// than kLongestGap, and times that do not increase or are unevenly spaced.
Record read_record(const Source& source, const RecordBase& base, const ReadOptions& options = {});

/// Adds a problem for each file of a record that cannot be read. Its content is not checked.
void check_files(const Source& source, Problems& problems);

/// Reads a record, with the staged events that apply to the file. If the breaker is open during the whole
/// record, P and Q are not required.
Record read_staged(const Source& source, const RecordBase& base, ReadOptions options);

/// Returns the name of a staged event in plant files: "vref_step".
std::string_view staged_name(StagedEvent::Kind kind);
constexpr int kStagedKinds = 5;  ///< number of kinds of staged events

/// Reads a record from the text of a CSV or playback file; `name` is the file's name in messages.
Record parse_record(std::string_view text, const std::string& name, const RecordBase& base,
                    const ReadOptions& options = {});

/// Returns the JSON Schema of a row of a record as an object: its columns with units and meaning.
std::string record_schema();

/// Returns the samples from `from` to `until` [s] with unchanged times. Throws InputError if too few remain.
Record stretch(Record record, double from, double until);

/// Returns the quantisation step of the values. Returns 0 if the values do not lie on a grid, or if more than
/// a third of them are distinct.
double quantum(const std::vector<double>& values);

/// Throws InputError if the record has neither a measured nor an integrated angle: play-in requires one.
void require_angle(const Record& record);

/// Returns seconds since 1970-01-01 as text: "2024-05-01T12:00:00.033333Z".
std::string utc_text(double epoch);

/// Returns a description of the time at t = 0: UTC, or the file's stamp with the remark that its time zone is
/// unknown; empty if neither exists.
std::string beginning(const Record& record);

}  // namespace swingbank::validate::record
