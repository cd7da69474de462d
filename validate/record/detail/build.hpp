#pragma once
// Common parts of the readers: choice of columns, list of faults, and conversion of raw columns to a Record.
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "validate/record/detail/columns.hpp"

namespace swingbank::validate::record {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

struct Heading {
  std::string name;  ///< as written in the file
  std::optional<ColumnMeaning> meaning;
  std::string unit = {};  ///< from another header line
  /// Returns whether the line of units or, without one, the brackets of the heading contain an unknown unit.
  [[nodiscard]] bool unknown_unit() const;
};

/// Faults of single samples. Consecutive samples with the same fault become one message.
class SampleFaults {
 public:
  /// Returns the location of samples first … last: "r.csv:5-9".
  using Where = std::function<std::string(std::size_t first, std::size_t last)>;
  explicit SampleFaults(Where where) : where_(std::move(where)) {}
  /// Adds a fault. Faults of consecutive samples with the same `subject` (usually a column) and `why` are
  /// merged; `what` describes the first.
  void add(const std::string& subject, std::string what, std::size_t sample, std::string why,
           std::string remedy);
  /// Adds a missing value. It is a fault only after report_missing().
  void lose(const std::string& subject, std::string what, std::size_t sample, std::string why,
            std::string remedy);
  /// Returns marks of the samples passed to lose(); empty if there are none.
  [[nodiscard]] std::vector<char> lost(std::size_t samples) const;
  /// Turns all missing values into faults, because a gap is longer than kLongestGap.
  void report_missing();
  /// Removes faults of samples outside first .. last.
  void keep(std::size_t first, std::size_t last);
  /// Renumbers the samples so that `first` becomes 0.
  void shift(std::size_t first);
  /// Keeps only these samples, renumbered from 0.
  void keep_rows(std::vector<std::size_t> rows);
  [[nodiscard]] std::string where(std::size_t sample) const { return where_(sample, sample); }
  /// Adds the faults to `problems`, in order; a long list is truncated.
  void report(Problems& problems, const std::string& file) const;

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
  std::vector<double> values;  ///< as written; NaN if missing or invalid
};

/// A file's columns before conversion of units, with properties that only its reader knows.
struct RawRecord {
  std::vector<RawColumn> columns;
  double time_resolution = 0;  ///< rounding of the times [in their own unit]; 0: not known
  bool uneven = false;         ///< the sample times are arbitrary, and values are linear between them
  Record about;                ///< name, format, terminal, start, ignored, notes
};

/// Returns the first column of the quantity; nullptr if there is none.
template <class Raw>
auto find_column(Raw& raw, Quantity q) -> decltype(raw.columns.data()) {
  for (auto& c : raw.columns)
    if (c.meaning.quantity == q) return &c;
  return nullptr;
}
/// Returns the column of the times, which every raw record has.
inline RawColumn& time_column(RawRecord& raw) { return *find_column(raw, Quantity::time); }

/// Returns the indices of the columns to read, in the file's order. Sets the meaning of the columns named in
/// options.columns, and adds unknown columns to `about.ignored`. Of several terminals, it chooses the
/// requested one or the only complete one. If the voltage is measured at one terminal and the power or
/// current at another, it chooses both. Adds a problem for each column that is repeated, missing or without a
/// unit.
std::vector<std::size_t> choose_columns(std::vector<Heading>& headings, const ReadOptions& options,
                                        const RecordBase& base, const std::string& where, Record& about,
                                        Problems& problems);

/// Converts units and times, interpolates short gaps, and computes power from the current if P and Q are not
/// given. Unwraps the angle, or integrates the frequency if the file has no angle. Throws InputError with
/// `problems`, `faults` and all faults found here.
Record build_record(RawRecord raw, const RecordBase& base, const ReadOptions& options, SampleFaults faults,
                    Problems problems, const std::string& file);

/// Returns the channel of a record; nullptr for a quantity that is converted to others.
std::vector<double>* channel(Record& record, Quantity quantity);
/// Returns a column's values at fractional row numbers, interpolated linearly; NaN where the row number is
/// NaN.
std::vector<double> at_places(const std::vector<double>& values, const std::vector<double>& places);
/// Integrates the frequency if no angle was recorded. Without a frequency, and for an exciter or governor,
/// the angle is zero and its source is AngleSource::none.
void settle_angle(Record& record, const ReadOptions& options);

/// Joins the columns of several files of one event to one record, sampled at the times of the file that
/// contains P (without P: of the last file). Throws InputError if a quantity is missing or occurs twice.
Record join_records(std::vector<Record> parts, const ReadOptions& options, const std::string& files);

}  // namespace swingbank::validate::record
