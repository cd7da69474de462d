#pragma once
// Reader of COMTRADE records (IEEE C37.111-1991, -1999 and -2013, IEC 60255-24): configuration and data,
// ASCII, BINARY, BINARY32 and FLOAT32. Analogue channels only; status channels are skipped.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::validate::record {

/// Analogue channel of a COMTRADE record with its samples.
struct ComtradeChannel {
  std::string id, phase, component, unit;  ///< identifier; phase; circuit component; unit of `values`
  double a = 1, b = 0;                     ///< value = a x + b [unit]
  double skew = 0;                         ///< delay of sampling after the time stamp [s]
  double primary = 1, secondary = 1;       ///< ratings of the instrument transformer
  bool secondary_values = false;           ///< a x + b refers to the secondary side
  std::vector<double> values;  ///< on the primary side [unit]; NaN where the file marks a missing value
};

/// Consecutive samples at one rate.
struct ComtradeStretch {
  double rate = 0;                 ///< [1/s]
  std::size_t first = 0, end = 0;  ///< half-open range of samples
};

/// Content of a COMTRADE record (IEEE Std C37.111): configuration and analogue samples.
struct Comtrade {
  std::string station, device;             ///< names of the station and of the recorder
  int revision = 0;                        ///< 1991, 1999 or 2013
  double nominal = 0;                      ///< nominal frequency of the grid [Hz]
  std::string start;                       ///< date and time of the first sample, with the day first
  std::string kind;                        ///< "ASCII", "BINARY", "BINARY32" or "FLOAT32"
  std::vector<double> t;                   ///< [s]; 0 at the file's first sample
  std::vector<ComtradeStretch> stretches;  ///< in order; empty if time stamps determine the times
  double resolution = 0;  ///< rounding of the time stamps [s]; 0 if a rate determines the times
  std::vector<ComtradeChannel> channels;  ///< analogue channels, in the order of the configuration
  std::vector<std::string> notes;         ///< repairs and resolved contradictions, as sentences

  std::string file;                 ///< name of the data file in messages
  std::vector<std::size_t> places;  ///< line (ASCII) or first byte of each sample
  /// Returns the location of samples: "event.dat:12", "event.dat, bytes 4096-4127".
  [[nodiscard]] std::string where(std::size_t first, std::size_t last) const;
  std::size_t sample_bytes = 0;  ///< size of a binary sample [bytes]; 0 for ASCII data
};

/// Returns the record of a configuration and its data; messages contain the names of the two files. Notes
/// report each resolved contradiction (data type, number of samples) and each repair (truncated last sample,
/// overflow of the time stamps). Throws InputError with every fault of the configuration or, if it has none,
/// of the data, each with its line or byte: unknown revisions, invalid numbers, gaps in the sample numbers, a
/// rate and stamps in different units.
Comtrade parse_comtrade(std::string_view cfg, std::string_view dat, const std::string& cfg_name,
                        const std::string& dat_name);

/// Converts the record to a single sampling rate. Waveforms (`min_rate` > 0) whose rates differ by at most 2
/// % are resampled at the mean rate. Otherwise the longest run of consecutive stretches of at least
/// `min_rate` samples/s is kept, and its faster stretches are decimated to the slowest rate. The changes are
/// noted. Rates that are not multiples of the slowest become a problem.
void make_even(Comtrade& comtrade, double min_rate, Problems& problems);

/// Returns the record of one .cff file (2013), which contains configuration and data.
Comtrade parse_cff(std::string_view cff, const std::string& name);

}  // namespace swingbank::validate::record
