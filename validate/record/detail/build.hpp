#pragma once
// What all readers of records share: the choice of columns, the list of faults, and the way from columns as
// written to a Record.
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "validate/record/detail/columns.hpp"

namespace swingbank::validate::record {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

struct Heading {
  std::string name;  ///< as the file writes it
  std::optional<ColumnMeaning> meaning;
  std::string unit = {};  ///< as another header line writes it
  /// Whether the heading, or the line of units, names a unit in brackets that is not known.
  [[nodiscard]] bool unknown_unit() const;
};

/// Faults of single samples. Neighbouring samples with the same fault become one sentence.
class SampleFaults {
 public:
  /// Where samples first … last stand: "r.csv:5-9".
  using Where = std::function<std::string(std::size_t first, std::size_t last)>;
  explicit SampleFaults(Where where) : where_(std::move(where)) {}
  /// `subject` is what may repeat (a column), `what` is told of the first sample.
  void add(const std::string& subject, std::string what, std::size_t sample, std::string why,
           std::string remedy);
  /// A value that is missing: a fault only if the gap is longer than kLongestGap, which tell_missing() says.
  void lose(const std::string& subject, std::string what, std::size_t sample, std::string why,
            std::string remedy);
  /// Marks the samples of lose(); empty if there are none.
  [[nodiscard]] std::vector<char> lost(std::size_t samples) const;
  void tell_missing();
  /// Forgets faults of samples outside first .. last.
  void keep(std::size_t first, std::size_t last);
  /// Samples are counted from `first` on.
  void shift(std::size_t first);
  /// Only these samples are left, and are counted from 0.
  void keep_rows(std::vector<std::size_t> rows);
  [[nodiscard]] std::string where(std::size_t sample) const { return where_(sample, sample); }
  /// Adds them to `problems`, in order; a long list is cut.
  void tell(Problems& problems, const std::string& file) const;

 private:
  struct Fault {
    std::string subject, what, why, remedy;
    std::size_t first, last;
  };
  static void add_to(std::vector<Fault>& faults, Fault fault);
  Where where_;
  std::vector<Fault> faults_, missing_;
};

struct RawColumn {
  std::string name;
  ColumnMeaning meaning;
  std::vector<double> values;  ///< as written; NaN where a fault was told
};

/// A file's columns, before units, and what only its reader knows.
struct RawRecord {
  std::vector<RawColumn> columns;
  double time_resolution = 0;  ///< what the times are rounded to [in their own unit]; 0: not known
  bool uneven = false;         ///< samples may stand at any distance, with straight lines between them
  Record about;                ///< name, format, terminal, start, ignored, notes
};

/// Columns to read, in the file's order; the meaning of those that options.columns names is set. Unknown ones
/// go to `about.ignored`. Of several terminals the one asked for is taken, or the only complete one, or,
/// where the voltage is measured at one and the current at another, both. Adds a problem for each column that
/// is repeated, unitless or missing.
std::vector<std::size_t> choose_columns(std::vector<Heading>& headings, const ReadOptions& options,
                                        const RecordBase& base, const std::string& where, Record& about,
                                        Problems& problems);

/// Converts units and times, bridges short gaps, computes power from the current where P and Q are not given,
/// and makes the angle continuous, or of the frequency where there is none. Throws InputError with
/// `problems`, `faults` and what it finds itself.
Record build_record(RawRecord raw, const RecordBase& base, const ReadOptions& options, SampleFaults faults,
                    Problems problems, const std::string& file);

/// The columns of several files of one event as one record, at the instants of the one that has P. Throws
/// InputError if a quantity is there twice or is missing.
Record join_records(std::vector<Record> parts, const ReadOptions& options, const std::string& files);

}  // namespace swingbank::validate::record
