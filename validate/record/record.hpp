#pragma once
// A PMU record of one plant's terminal: what was measured, uniformly sampled, with its units settled on
// reading.
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::validate::record {

/// What a record's columns are measured in where the column name says "pu".
struct RecordBase {
  double mva = 100.0;       ///< base of P_pu and Q_pu [MVA]
  double frequency = 60.0;  ///< base of f_pu and omega_pu [Hz]
  double kv = 0.0;          ///< base of voltages in kV, line to line; 0: the file may not use kV
  /// What the model's 1 pu (air-gap line) of field voltage and current is in the record's own unit: per unit
  /// of another base, V or A; 0: the record's pu is the model's, and the file may not use V or A.
  double efd = 0.0, ifd = 0.0;
};

/// Where a record's angle comes from. An integrated one lacks what a switching turns it at once; a missing
/// one stands as zeros.
enum class AngleSource { measured, integrated, none };

/// What of a plant is tried: all of it, or one part, which the record drives with what the others did.
enum class Component {
  plant,     ///< V and its angle drive; P and Q are compared
  exciter,   ///< V drives, with Vs, Ifd and what else its blocks ask for; Efd is compared
  governor,  ///< the speed drives, with Pref; Pm or the gate is compared
  machine,   ///< V, its angle and Efd drive, with Pm; P, Q and Ifd are compared
};
std::string_view component_name(Component component);

/// What a test does to the plant, beside what the record shows.
struct StagedEvent {
  enum class Kind {
    vref_step,       ///< the exciter's reference moves by `size` [pu]
    pref_step,       ///< the governor's reference moves by `size` [pu on base.mva of the record]
    efd_step,        ///< the field voltage of an exciter by hand moves by `size` [pu]
    open_circuit,    ///< the breaker is open all the time
    load_rejection,  ///< the breaker opens at `time`
  };
  Kind kind = Kind::vref_step;
  double time = 0, until = std::numeric_limits<double>::infinity();  ///< a step comes and goes [s]
  double size = 0;
  std::string record = {};  ///< file name of the record it belongs to; empty: all
  [[nodiscard]] bool opens_breaker() const { return kind >= Kind::open_circuit; }
  friend bool operator==(const StagedEvent&, const StagedEvent&) = default;
};

/// Samples of one terminal. All vectors have the length of `t`; optional channels are empty if not recorded.
struct Record {
  std::string name;    ///< file name without folder
  std::string sha256;  ///< of the file's bytes (of a COMTRADE record: .cfg, then .dat)
  RecordBase base;
  std::vector<double> t;             ///< [s], increasing, uniform
  std::vector<double> V, theta;      ///< [pu], [rad] (unwrapped)
  std::vector<double> P, Q;          ///< out of the machine [pu on base.mva]
  std::vector<double> f;             ///< optional: frequency deviation [pu]
  std::vector<double> speed;         ///< optional: rotor speed deviation [pu]
  std::vector<double> Efd, Ifd;      ///< optional [pu]
  std::vector<double> Vs, Vref;      ///< optional: stabiliser output, reference of the voltage [pu]
  std::vector<double> Pm, Pref;      ///< optional: mechanical power, its reference [pu on base.mva]
  std::vector<double> gate;          ///< optional: opening of gate or valve [pu]
  std::vector<std::string> ignored;  ///< columns of the file that were not read

  std::string format = "CSV";            ///< what kind of file it was
  std::string terminal;                  ///< which of the file's terminals, where it names them
  std::string start;                     ///< the file's own stamp of t = 0, where it has one
  std::optional<double> epoch;           ///< UTC of t = 0 [s since 1970-01-01], where the file tells it
  std::vector<std::string> notes;        ///< what reading did that a reader of results must know
  std::vector<double> theta_as_written;  ///< [rad], before unwrapping; empty if made otherwise
  AngleSource angle = AngleSource::measured;
  bool per_unit_power = true;              ///< P and Q, or the current, were written in pu; false: in MW or A
  std::vector<std::string> named;          ///< quantities whose column was chosen by ReadOptions::columns
  Component component = Component::plant;  ///< what it is read for
  std::vector<StagedEvent> staged;         ///< what was done to the plant while it ran
  std::vector<double> switched;  ///< instants of switchings that a person knows [s]; empty: the jumps tell
  /// Marks samples that are not compared: frames that were not recorded, whose voltage is bridged, and frames
  /// in which a channel that is compared has no value. Empty: none.
  std::vector<char> lost;

  /// The event that takes the plant off the grid; nullptr: none does, or a part of it is tried that does not
  /// see the grid.
  [[nodiscard]] const StagedEvent* breaker() const;
  [[nodiscard]] bool open_circuit() const {
    return breaker() && breaker()->kind == StagedEvent::Kind::open_circuit;
  }
  /// When the first of them comes [s]; infinity: none.
  [[nodiscard]] double first_staged() const;
  [[nodiscard]] int samples() const { return static_cast<int>(t.size()); }
  [[nodiscard]] double step() const { return (t.back() - t.front()) / static_cast<double>(t.size() - 1); }
  [[nodiscard]] double rate() const { return 1.0 / step(); }
};

/// The angle against nominal frequency, from zero, integrated from the record's f [rad].
std::vector<double> angle_of_frequency(const Record& record);
/// Adds to each angle [rad] the whole turns that bring it closest to the one before; values that are not
/// finite stay. So plots and differences of angles make sense.
void unwrap(std::vector<double>& angle);

/// Fewest samples a record may have: a pre-event window and a response cannot be told from less.
constexpr int kMinSamples = 30;
/// Shortest record [s]: nothing that a model does shows in less.
constexpr double kShortestRecord = 0.1;
/// Frames that a stream lost are bridged up to this length [s].
constexpr double kLongestGap = 0.2;

/// Which column of the file gives a quantity: {"V", "BUS1.VPM [kV]"}. Words are those of names_of(); the
/// column is the heading or "#3" for the third one, with its unit in brackets where the file gives none; a
/// "-" before it turns the sign.
using ColumnMap = std::map<std::string, std::string>;

struct ReadOptions {
  std::string terminal{};  ///< which terminal, where the file holds several
  ColumnMap columns{};     ///< chosen by name; the others are found by themselves
  double from = -std::numeric_limits<double>::infinity();  ///< samples before it are left out [s]
  double until = std::numeric_limits<double>::infinity();  ///< samples after it are left out [s]
  double phasor_rate = 0;  ///< phasors per second made of waveforms; 0: one per nominal cycle
  bool power = true;       ///< P and Q are needed (or the current); false: they stay empty where not given
  bool part = false;       ///< one of several files: what it lacks stands in another
  Component component = Component::plant;  ///< which part of the plant is tried
  /// What a component's record must have: one word of each list ({"speed", "f"}).
  std::vector<std::vector<std::string>> needed = {};
  std::vector<StagedEvent> staged = {};  ///< what was done to the plant, of all its records
  bool angle = false;  ///< the angle is needed; false: it may be integrated from f, or be missing
};

/// Reads a record; the name's ending says what it is: .cfg/.dat or .cff COMTRADE, .h5 a run of
/// `swingbank simulate`, anything else text in columns (validate/record/README.md lists names, units and
/// dialects). "FILE#TERMINAL" picks one terminal of several, "FILE+FILE" joins the columns of several files
/// of one event. Columns that are not measurements of the terminal are left out and listed in `ignored`.
/// Throws InputError with every fault of the file: missing, repeated or unitless columns, ragged lines,
/// values that are no finite numbers or missing for longer than kLongestGap, times that do not increase or
/// are unevenly spaced, too few samples. Each names its lines or bytes. What was mended (shorter gaps, stamps
/// repeated, a clock that leapt) stands in `notes`. What a readable record means is for check_record
/// (validate/check/check.hpp).
Record read_record(const std::filesystem::path& file, const RecordBase& base,
                   const ReadOptions& options = {});

/// What the record of such a name is called: without folders, "a.csv#NORTH", "a.csv+b.csv".
std::string record_name(const std::filesystem::path& named);

/// The same with the staged events that belong to the file. Of a plant whose breaker is open all the time P
/// and Q are not needed.
Record read_staged(const std::filesystem::path& file, const RecordBase& base, ReadOptions options);

/// The word of a plant file: "vref_step".
std::string_view staged_name(StagedEvent::Kind kind);
constexpr int kStagedKinds = 5;

/// The same from the text of a CSV file; `name` stands for the file in messages.
Record parse_record(std::string_view text, const std::string& name, const RecordBase& base,
                    const ReadOptions& options = {});

/// The record from `from` to `until` [s]; the times stay as they are. Throws InputError if too little is
/// left.
Record stretch(Record record, double from, double until);

/// The step of values that come in steps: all lie on a grid that has a third of the values at most. 0: no
/// such grid.
double quantum(const std::vector<double>& values);

/// Throws InputError if the record has no angle, measured or integrated: its voltage then drives no model.
void require_angle(const Record& record);

/// "2024-05-01T12:00:00.033333Z" of seconds since 1970-01-01.
std::string utc_text(double epoch);

/// What is known of the time at t = 0: UTC, or the file's own stamp and that its zone is not known; empty
/// where neither is.
std::string beginning(const Record& record);

}  // namespace swingbank::validate::record
