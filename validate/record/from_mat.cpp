// Reader of MATLAB files (v4, v5 and v7.3, by libmatio): vectors, tables of columns and structs of both.
#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/read_apart.hpp"
#include "base/sha256.hpp"
#include "validate/record/detail/columns.hpp"
#include "validate/record/detail/text.hpp"
#include "validate/record/formats.hpp"
#include "validate/record/mat_text.hpp"

namespace swingbank::validate::record {
namespace {

constexpr const char* kExport =
    "save vectors: save('event.mat', 't_s', 'V_kV', 'f_Hz', 'P_MW', 'Q_Mvar'), or name the variables: "
    "--columns \"t=NAME [s],V=NAME [kV],…\"";
constexpr int kDeepestStruct = 4;  ///< maximum depth of nested structs

struct MatColumn {
  std::string name;
  std::vector<double> values;
};

std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t width, bool swapped = false) {
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < width; ++k)
    value = value << 8U | static_cast<unsigned char>(bytes[at + (swapped ? k : width - 1 - k)]);
  return value;
}
/// Returns whether a v7.3 file (HDF5 after a header of 512 bytes) is shorter than its superblock states.
bool hdf5_is_cut_off(std::string_view bytes) {
  constexpr std::size_t kBegin = 512;
  if (bytes.size() < kBegin + 64 || !bytes.substr(kBegin).starts_with("\x89HDF")) return true;
  const auto version = bytes[kBegin + 8];
  const std::size_t addresses = version == 0 ? 24
                                : version == 1
                                    ? 28
                                    : 12;  // offset of the addresses; the third one is the end of the file
  return bytes.size() < number_at(bytes, kBegin + addresses + 16, 8);
}
/// Returns whether a file is truncated. A v5 file consists of elements with stated lengths; it is truncated
/// if it ends within an element.
bool is_cut_off(std::string_view bytes) {
  if (bytes.starts_with("MATLAB 7.3")) return hdf5_is_cut_off(bytes);
  if (!bytes.starts_with("MATLAB 5")) return false;
  if (bytes.size() < 128) return true;
  std::size_t at = 128;
  while (at + 8 <= bytes.size()) at += 8 + number_at(bytes, at + 4, 4, bytes[126] == 'M');
  return at != bytes.size();
}

template <class T>
std::vector<double> copied(const matvar_t& v, std::size_t n) {
  const T* from = static_cast<const T*>(v.data);
  return {from, from + n};
}
std::size_t elements(const matvar_t& v) {
  std::size_t n = v.rank > 0 ? 1 : 0;
  for (int k = 0; k < v.rank; ++k) n *= v.dims[k];
  return n;
}
/// Returns real numbers of any width; none if the variable contains something else.
std::optional<std::vector<double>> numbers(const matvar_t& v) {
  const std::size_t n = elements(v);
  if (v.data == nullptr || v.isComplex != 0 || v.rank != 2 || v.class_type == MAT_C_CHAR ||
      v.data_size <= 0 || n * static_cast<std::size_t>(v.data_size) > v.nbytes)
    return std::nullopt;
  switch (v.class_type) {
    case MAT_C_DOUBLE:
    case MAT_C_SINGLE:
    case MAT_C_INT8:
    case MAT_C_UINT8:
    case MAT_C_INT16:
    case MAT_C_UINT16:
    case MAT_C_INT32:
    case MAT_C_UINT32:
    case MAT_C_INT64:
    case MAT_C_UINT64:
      break;
    default:
      return std::nullopt;
  }
  switch (v.data_type) {
    case MAT_T_DOUBLE:
      return copied<double>(v, n);
    case MAT_T_SINGLE:
      return copied<float>(v, n);
    case MAT_T_INT8:
      return copied<std::int8_t>(v, n);
    case MAT_T_UINT8:
      return copied<std::uint8_t>(v, n);
    case MAT_T_INT16:
      return copied<std::int16_t>(v, n);
    case MAT_T_UINT16:
      return copied<std::uint16_t>(v, n);
    case MAT_T_INT32:
      return copied<std::int32_t>(v, n);
    case MAT_T_UINT32:
      return copied<std::uint32_t>(v, n);
    case MAT_T_INT64:
      return copied<std::int64_t>(v, n);
    case MAT_T_UINT64:
      return copied<std::uint64_t>(v, n);
    default:
      return std::nullopt;
  }
}

/// Returns the text of one row; characters other than ASCII become '?'.
std::string text_of(const matvar_t& v, std::size_t row = 0) {
  std::string text;
  if (v.class_type != MAT_C_CHAR || v.rank != 2 || v.data == nullptr || row >= v.dims[0]) return text;
  const std::size_t width = v.data_type == MAT_T_UINT16 || v.data_type == MAT_T_UTF16 ? 2 : 1;
  for (std::size_t c = 0; c < v.dims[1]; ++c) {
    const std::size_t at = (c * v.dims[0] + row) * width;
    if (at + width > v.nbytes) break;
    const auto* bytes = static_cast<const unsigned char*>(v.data) + at;
    const unsigned code = width == 2 ? bytes[0] | bytes[1] << 8U : bytes[0];
    text += code >= 0x20 && code < 0x7F ? static_cast<char>(code) : '?';
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}
/// Returns the words of a cell array of texts, or the rows of a character matrix; empty if it is neither.
std::vector<std::string> words(const matvar_t& v) {
  std::vector<std::string> all;
  if (v.class_type == MAT_C_CHAR && v.rank == 2)
    for (std::size_t r = 0; r < v.dims[0]; ++r) all.push_back(text_of(v, r));
  if (v.class_type == MAT_C_CELL && v.data != nullptr)
    for (std::size_t k = 0; k < elements(v) && k < v.nbytes / sizeof(matvar_t*); ++k) {
      const matvar_t* cell = static_cast<matvar_t**>(v.data)[k];
      if (cell == nullptr || cell->class_type != MAT_C_CHAR) return {};
      all.push_back(text_of(*cell));
    }
  return all;
}

bool is_word(std::string_view name, std::string_view word) { return normalised(name) == word; }
bool is_time(const std::string& name) {
  const auto meaning = column_meaning(name);
  return meaning && meaning->quantity == Quantity::time;
}

class MatReader {
 public:
  explicit MatReader(std::string name) : name_(std::move(name)) {}

  void variable(matvar_t& v) { take(v, v.name == nullptr ? "?" : v.name, "", 0); }

  /// Returns the columns as text separated by tabs, which parse_record reads. A vector that is not as long as
  /// the time is an empty column (numbers of columns then still count it), or an error if it has the name of
  /// a quantity.
  std::string text(const std::string& time) {
    name_tables();
    const std::size_t rows = time_rows(time);
    std::string other;
    for (MatColumn& c : columns_)
      if (c.values.size() != rows) {
        if (column_meaning(c.name)) other += fmt::format(", {} has {}", c.name, c.values.size());
        c.values.clear();
      }
    if (!other.empty())
      refuse("vectors of different lengths", fmt::format("the time has {} samples{}", rows, other),
             "save one value per sample, and remove or rename vectors of another event");
    std::string out;
    for (std::size_t c = 0; c < columns_.size(); ++c) out += (c > 0 ? "\t" : "") + columns_[c].name;
    for (std::size_t r = 0; r < rows; ++r) {
      out += '\n';
      for (std::size_t c = 0; c < columns_.size(); ++c) {
        if (c > 0) out += '\t';
        if (!columns_[c].values.empty()) fmt::format_to(std::back_inserter(out), "{}", columns_[c].values[r]);
      }
    }
    return out + '\n';
  }

 private:
  struct Table {
    std::string name, place;
    std::size_t rows, columns;
    std::vector<double> values;
  };
  struct Words {
    std::string place;
    std::vector<std::string> list;
  };

  void take(matvar_t& v, const std::string& name, const std::string& place, int depth) {
    if (v.class_type == MAT_C_STRUCT) return structure(v, name, depth);
    const std::string full = place.empty() || is_time(name) ? name : place + "." + name;
    std::string size;
    for (int k = 0; k < v.rank; ++k) size += (k > 0 ? "x" : "") + std::to_string(v.dims[k]);
    seen_.push_back(fmt::format("{} ({}{})", full, size, v.isComplex != 0 ? ", complex" : ""));
    if (auto list = words(v); !list.empty()) return words_.push_back({place, std::move(list)});
    auto values = numbers(v);
    if (!values || values->size() < 2) return;
    if (v.dims[0] == 1 || v.dims[1] == 1) return add(full, std::move(*values));
    tables_.push_back({full, place, v.dims[0], v.dims[1], std::move(*values)});
  }

  /// Reads one struct. It contains columns, or a signal with its own times: "Time" and "Data" in a saved
  /// timeseries, "time" and "signals" in a log of Simulink.
  void structure(matvar_t& v, const std::string& name, int depth) {
    if (elements(v) == 0 || v.data == nullptr || depth >= kDeepestStruct)
      return seen_.push_back(name + " (struct)");
    const unsigned fields = Mat_VarGetNumberOfFields(&v);
    const char* const* names = Mat_VarGetStructFieldnames(&v);
    const std::size_t parts = elements(v);
    for (std::size_t part = 0; part < parts; ++part) {
      std::string label;
      for (unsigned f = 0; f < fields; ++f)
        if (matvar_t* field = Mat_VarGetStructFieldByIndex(&v, f, part);
            field != nullptr && (is_word(names[f], "label") || is_word(names[f], "signalname")))
          label = text_of(*field);
      for (unsigned f = 0; f < fields; ++f) {
        matvar_t* field = Mat_VarGetStructFieldByIndex(&v, f, part);
        if (field == nullptr) continue;
        const bool data = is_word(names[f], "data") || is_word(names[f], "values");
        if (data)
          take(*field, label.empty() ? name : label, "", depth + 1);
        else if (parts == 1 || field->class_type != MAT_C_CHAR)
          take(*field, names[f], name, depth + 1);
      }
    }
  }

  /// Adds a column. Of several time columns, the first is added; different ones are listed in other_times_.
  void add(const std::string& name, std::vector<double> values) {
    if (is_time(name))
      for (const MatColumn& c : columns_)
        if (is_time(c.name)) {
          if (c.values != values) other_times_.push_back(name);
          return;
        }
    columns_.push_back({tidy(name), std::move(values)});
  }
  static std::string tidy(std::string name) {
    std::ranges::replace_if(
        name, [](char c) { return c == '\t' || c == '"' || c == '\n' || c == '\r'; }, ' ');
    return name;
  }

  /// Converts matrices to columns. If a list has as many names as a matrix has columns (or rows), these get
  /// the names of the list.
  void name_tables() {
    for (const Table& table : tables_) {
      const Words* names = nullptr;
      for (const Words& w : words_)
        if (w.list.size() == table.columns || w.list.size() == table.rows)
          if (names == nullptr || w.place == table.place) names = &w;
      const bool lying = names != nullptr && names->list.size() == table.rows && table.rows < table.columns;
      const std::size_t signals = lying ? table.rows : table.columns,
                        length = lying ? table.columns : table.rows;
      for (std::size_t s = 0; s < signals; ++s) {
        std::vector<double> values(length);
        for (std::size_t k = 0; k < length; ++k)
          values[k] = table.values[lying ? k * table.rows + s : s * table.rows + k];
        add(names != nullptr && names->list.size() == signals ? names->list[s]
                                                              : fmt::format("{}(:,{})", table.name, s + 1),
            std::move(values));
      }
    }
  }

  /// Returns the number of samples of the time column `asked`; if empty, of the first time column.
  [[nodiscard]] std::size_t time_rows(const std::string& asked) const {
    if (!other_times_.empty())
      refuse("signals with different times", "one record has one time vector",
             "resample them to common times in MATLAB (resample, synchronize)");
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      const MatColumn& c = columns_[k];
      const auto means = [&](const std::string& name) {
        return asked == name || asked.starts_with(name + " [");
      };
      if (asked.empty() ? is_time(c.name) : means(c.name) || means(fmt::format("#{}", k + 1)))
        return c.values.size();
    }
    if (asked.empty())
      refuse("no time vector", "no variable has a name of the time, such as t, time or timestamp", kExport);
    refuse(fmt::format("no time vector '{}'", asked), "no variable has this name or number", kExport);
  }
  [[noreturn]] void refuse(const std::string& what, const std::string& why, const std::string& remedy) const {
    std::string all;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      if (k == 40) {
        all += fmt::format(" and {} more", seen_.size() - k);
        break;
      }
      all += (k > 0 ? ", " : "") + seen_[k];
    }
    throw InputError(
        {what, name_, fmt::format("{}; the file holds {}", why, all.empty() ? "nothing" : all), remedy});
  }

  std::string name_;
  std::vector<MatColumn> columns_;
  std::vector<Table> tables_;
  std::vector<Words> words_;
  std::vector<std::string> seen_, other_times_;
};

}  // namespace

std::string mat_text(const std::filesystem::path& file, const std::string& time) {
  const std::string name = file.string(), bytes = read_bytes(file);
  const auto broken = [&](const char* why) {
    return InputError({"cannot read the MATLAB file", name, why, "copy or save it again"});
  };
  if (is_cut_off(bytes)) throw broken("the last variable is truncated");
  const std::unique_ptr<mat_t, int (*)(mat_t*)> mat(Mat_Open(name.c_str(), MAT_ACC_RDONLY), Mat_Close);
  if (!mat) throw broken("the file is truncated, or is not a MATLAB file");
  MatReader reader(name);
  while (true) {
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> v(Mat_VarReadNext(mat.get()), Mat_VarFree);
    if (!v) break;
    reader.variable(*v);
  }
  const bool hdf5 = Mat_GetVersion(mat.get()) == MAT_FT_MAT73;
  return std::string(hdf5 ? "MATLAB 7.3" : "MATLAB") + '\n' + reader.text(time);
}

Record read_mat_record(const std::filesystem::path& file, const RecordBase& base,
                       const ReadOptions& options) {
  const std::string bytes = read_bytes(file);
  std::vector<std::string> time;
  if (const auto asked = options.columns.find("t"); asked != options.columns.end())
    time.push_back(asked->second);
  const std::string text = read_apart("mat", file, time);
  std::string_view rest = text;
  const std::string_view format = take_line(rest);
  Record record = parse_record(rest, fmt::format("columns of {}", file.filename().string()), base, options);
  record.sha256 = sha256(bytes);
  record.format = format;
  return record;
}

}  // namespace swingbank::validate::record
