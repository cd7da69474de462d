#pragma once
// A PMU record of one plant's terminal: what was measured, uniformly sampled, with its units settled on
// reading.
#include <cstdint>
#include <filesystem>
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
};

/// Samples of one terminal. All vectors have the length of `t`; optional channels are empty if not recorded.
struct Record {
  std::string name;        ///< file name without folder
  std::uint64_t hash = 0;  ///< XXH64 of the file's bytes (of a COMTRADE record: .cfg, then .dat)
  RecordBase base;
  std::vector<double> t;             ///< [s], increasing, uniform
  std::vector<double> V, theta;      ///< [pu], [rad] (unwrapped)
  std::vector<double> P, Q;          ///< out of the machine [pu on base.mva]
  std::vector<double> f;             ///< optional: frequency deviation [pu]
  std::vector<double> speed;         ///< optional: rotor speed deviation [pu]
  std::vector<double> Efd, Ifd;      ///< optional [pu]
  std::vector<std::string> ignored;  ///< columns of the file that were not read

  std::string format = "CSV";            ///< what kind of file it was
  std::string terminal;                  ///< which of the file's terminals, where it names them
  std::string start;                     ///< the file's own stamp of the first sample, where it has one
  std::vector<std::string> notes;        ///< what reading did that a reader of results must know
  std::vector<double> theta_as_written;  ///< [rad], before unwrapping; empty if made otherwise

  [[nodiscard]] int samples() const { return static_cast<int>(t.size()); }
  [[nodiscard]] double step() const { return (t.back() - t.front()) / static_cast<double>(t.size() - 1); }
  [[nodiscard]] double rate() const { return 1.0 / step(); }
};

/// Fewest samples a record may have: a pre-event window and a response cannot be told from less.
constexpr int kFewestSamples = 30;

struct ReadOptions {
  std::string terminal{};  ///< which terminal, where the file holds several
  double phasor_rate = 0;  ///< phasors per second made of waveforms; 0: one per nominal cycle
  bool power = true;       ///< P and Q are needed (or the current); false: they stay empty where not given
};

/// Reads a record; the name's ending says what it is: .cfg/.dat or .cff COMTRADE, .h5 a run of
/// `swingbank simulate`, anything else text in columns (validate/record/README.md lists names, units and
/// dialects). "FILE#TERMINAL" picks one terminal of several. Columns that are not measurements of the
/// terminal are left out and listed in `ignored`. Throws InputError with every fault of the file: missing,
/// repeated or unitless columns, ragged lines, values that are missing or no finite numbers, times that do
/// not increase or are unevenly spaced, too few samples. Each names its lines or bytes. What a readable
/// record means is for check_record (validate/check/check.hpp).
Record read_record(const std::filesystem::path& file, const RecordBase& base,
                   const ReadOptions& options = {});

/// The same from the text of a CSV file; `name` stands for the file in messages.
Record parse_record(std::string_view text, const std::string& name, const RecordBase& base,
                    const ReadOptions& options = {});

}  // namespace swingbank::validate::record
