#pragma once
// COMTRADE (IEEE C37.111-1991, -1999 and -2013, IEC 60255-24): configuration and data, ASCII, BINARY,
// BINARY32 and FLOAT32. Analogue channels only; status channels are skipped.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::validate::record {

struct ComtradeChannel {
  std::string id, phase, component, unit;
  double a = 1, b = 0;                ///< value = a x + b [unit]
  double skew = 0;                    ///< sampled that much later than stamped [s]
  double primary = 1, secondary = 1;  ///< of the instrument transformer
  bool secondary_values = false;      ///< a x + b is on the secondary side
  std::vector<double> values;         ///< on the primary side [unit]; NaN where the file marks none
};

/// Samples that follow one another at one rate.
struct ComtradeStretch {
  double rate = 0;                 ///< [1/s]
  std::size_t first = 0, end = 0;  ///< samples from `first` to before `end`
};

struct Comtrade {
  std::string station, device;
  int revision = 0;                        ///< 1991, 1999 or 2013
  double nominal = 0;                      ///< of the grid [Hz]
  std::string start;                       ///< date and time of the first sample, as written
  std::string kind;                        ///< "ASCII", "BINARY", "BINARY32" or "FLOAT32"
  std::vector<double> t;                   ///< [s]; 0 at the first sample
  std::vector<ComtradeStretch> stretches;  ///< in order; empty where stamps tell the times
  double resolution = 0;                   ///< what stamps are rounded to [s]; 0 where a rate gives the times
  std::vector<ComtradeChannel> channels;
  std::vector<std::string> notes;

  std::string file;                 ///< the data's name in messages
  std::vector<std::size_t> places;  ///< line (ASCII) or first byte of each sample
  /// "event.dat:12", "event.dat, bytes 4096-4127".
  [[nodiscard]] std::string where(std::size_t first, std::size_t last) const;
  std::size_t sample_bytes = 0;  ///< 0: lines
};

/// Reads configuration and data; the names stand for the files in messages. Notes what the files state
/// wrongly and the data show: the data type, the number of samples, a last sample that is cut, stamps that
/// passed the largest number they can hold. Throws InputError with every fault of both: unknown revisions,
/// broken numbers, samples numbered with gaps, a rate and stamps in different units. Lines and bytes are
/// named.
Comtrade parse_comtrade(std::string_view cfg, std::string_view dat, const std::string& cfg_name,
                        const std::string& dat_name);

/// Makes the record one of a single rate. Stretches slower than `fewest` [1/s] are left out, beside the
/// longest run of others; of those that are left the faster ones keep every n-th sample only. What was done
/// is noted; rates that are no multiples of the slowest become a problem.
void make_even(Comtrade& comtrade, double fewest, Problems& problems);

/// The same from one .cff file (2013), which holds both.
Comtrade parse_cff(std::string_view cff, const std::string& name);

}  // namespace swingbank::validate::record
