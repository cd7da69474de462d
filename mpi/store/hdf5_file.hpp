#pragma once
// C++ wrapper of HDF5's C API: owning handles, and errors with file and object. HDF5's own error output is
// off. Created files contain no time stamps, so equal content gives equal bytes.
#include <hdf5.h>

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace swingbank::mpi::store::h5 {

/// Returns the mutex that every user of HDF5 must hold, because HDF5 is not thread-safe.
std::recursive_mutex& lock();

/// Set when an object could not be closed (full disk) or was left open. HDF5 1.10 then crashes or hangs in
/// H5close, which the end of MPI and exit() also call.
inline std::atomic<bool> close_failed = false;
/// Stores the reason of the first failed close, because HDF5 discards it at its next call.
void note_failed_close();
/// At the first call, returns the reason that note_failed_close() stored; afterwards returns an empty text.
/// Needed because a destructor that closes an object cannot throw.
std::string unreported_failed_close();

/// Owner of an HDF5 identifier.
class Handle {
 public:
  /// HDF5 function that closes the object, for example H5Dclose.
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  /// Takes ownership of `id`; a negative `id` owns nothing.
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  /// Takes over the object of `other`, which then owns nothing.
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  /// Exchanges the objects; the previous object of this handle is closed with `other`.
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { reset(); }
  /// Closes the object. Returns false if HDF5 fails to close it.
  bool reset() {
    if (id_ < 0 || close_(std::exchange(id_, -1)) >= 0) return true;
    note_failed_close();
    return false;
  }
  /// Releases the identifier without closing it; the process must then end without H5close.
  void abandon() {
    if (std::exchange(id_, -1) >= 0) close_failed = true;
  }
  /// Returns the identifier; negative if there is none.
  [[nodiscard]] hid_t get() const { return id_; }
  /// Whether an object is owned.
  explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// HDF5 types of T: memory() is the native type, file() the little-endian type, and kKind the short name.
template <class T>
struct Type;
/// \cond
template <>
struct Type<float> {
  static constexpr const char* kKind = "f4";
  static hid_t memory() { return H5T_NATIVE_FLOAT; }
  static hid_t file() { return H5T_IEEE_F32LE; }
};
template <>
struct Type<double> {
  static constexpr const char* kKind = "f8";
  static hid_t memory() { return H5T_NATIVE_DOUBLE; }
  static hid_t file() { return H5T_IEEE_F64LE; }
};
template <>
struct Type<std::uint64_t> {
  static constexpr const char* kKind = "u8";
  static hid_t memory() { return H5T_NATIVE_UINT64; }
  static hid_t file() { return H5T_STD_U64LE; }
};
template <>
struct Type<std::int32_t> {
  static constexpr const char* kKind = "i4";
  static hid_t memory() { return H5T_NATIVE_INT32; }
  static hid_t file() { return H5T_STD_I32LE; }
};
template <>
struct Type<std::int16_t> {
  static constexpr const char* kKind = "i2";
  static hid_t memory() { return H5T_NATIVE_INT16; }
  static hid_t file() { return H5T_STD_I16LE; }
};
template <>
struct Type<std::uint8_t> {
  static constexpr const char* kKind = "u1";
  static hid_t memory() { return H5T_NATIVE_UINT8; }
  static hid_t file() { return H5T_STD_U8LE; }
};
/// \endcond

/// Length of each dimension of an array.
using Shape = std::vector<hsize_t>;

class Contents;

/// HDF5 file. All members throw InputError on failure.
class File {
 public:
  /// Opens a file whose checksum was verified; HDF5 1.10 may crash on a damaged file.
  static File open(const std::filesystem::path& file);
  /// Reads the named arrays ("/records") and attributes ("@format") of an untrusted file in a separate
  /// process. The other objects of the file are not accessible.
  static File open_apart(const std::filesystem::path& file, const std::vector<std::string>& names);
  /// Creates a file. `access`: a file-access property list (MPI-IO), or -1 for the default driver.
  static File create(const std::filesystem::path& file, hid_t access = -1);
  /// Closes the file. Throws if buffered data could not be written, also if this happened when an earlier
  /// object was closed.
  void close();
  /// Leaves the file open after the failure of one rank: HDF5 closes a file collectively and waits forever if
  /// the ranks' states differ.
  void abandon() { file_.abandon(); }

  /// Returns whether the file has an array or group of this name.
  [[nodiscard]] bool has(const std::string& object) const;
  /// Returns the length of each dimension of an array.
  [[nodiscard]] Shape shape(const std::string& object) const;
  /// Returns Type<T>::kKind of an array's type in the file; empty if there is no such T. For a file from
  /// open_apart, returns the kind of the transferred array.
  [[nodiscard]] std::string kind(const std::string& object) const;
  /// Creates a group, "/draws".
  void create_group(const std::string& name);
  /// Creates an array with this HDF5 type.
  void create(const std::string& object, hid_t file_type, const Shape& shape);
  /// Creates an array with the file type of T.
  template <class T>
  void create(const std::string& object, const Shape& shape) {
    create(object, Type<T>::file(), shape);
  }

  /// Source of a virtual array: an array of another file with `count` rows.
  struct Part {
    std::string file, object;  ///< file name relative to this file's folder
    hsize_t count;             ///< number of rows
  };
  /// Creates a virtual array: the rows of other files, concatenated. Type and row shape are those of the
  /// object with the same name in `example`.
  void create_virtual(const std::string& object, const File& example, const std::vector<Part>& parts);

  /// Reads rows first ... first+count-1 of the leading dimension; resizes `values`.
  template <class T>
  void read(const std::string& object, hsize_t first, hsize_t count, std::vector<T>& values) const {
    if (contents_) {
      values.resize(values_apart(object, first, count, Type<T>::kKind));
      return copy_apart(object, first, count, values.data());
    }
    const std::size_t n = values_in(object, count, sizeof(T));
    try {
      values.resize(n);
    } catch (const std::bad_alloc&) {
      too_large(object, n, sizeof(T));
    }
    transfer(object, first, count, Type<T>::memory(), values.data(), nullptr);
  }
  /// Reads the whole array; resizes `values`.
  template <class T>
  void read(const std::string& object, std::vector<T>& values) const {
    const Shape s = shape(object);
    read(object, 0, s.empty() ? 0 : s[0], values);
  }
  /// Writes rows first ... first+count-1 of the leading dimension.
  template <class T>
  void write(const std::string& object, hsize_t first, hsize_t count, const T* values) {
    transfer(object, first, count, Type<T>::memory(), nullptr, values);
  }

  /// Creates a one-dimensional array of texts, stored with a fixed length in UTF-8.
  void create_labels(const std::string& object, const std::vector<std::string>& labels);
  /// Writes the texts `labels`, with which create_labels was called.
  void write_labels(const std::string& object, const std::vector<std::string>& labels);
  /// Writes the attributes `units` and `long_name` of an array, which viewers and xarray display.
  void describe(const std::string& object, const std::string& units, const std::string& long_name);
  /// Array and, for each of its axes, the one-dimensional array with the axis' values.
  struct Axes {
    std::string array;                ///< "/records"
    std::vector<std::string> scales;  ///< one for each dimension: "/sample_id", "/channel", "/time"
  };
  /// Attaches the HDF5 dimension scales to their arrays. Call it once per file.
  void attach_scales(const std::vector<Axes>& all);

  /// Writes a text as attribute of `object`.
  void attribute(const std::string& name, const std::string& value, const std::string& object = "/");
  /// Writes a list of texts as attribute of `object`.
  void attribute(const std::string& name, const std::vector<std::string>& value,
                 const std::string& object = "/");
  /// Writes an integer as attribute of `object`.
  void attribute(const std::string& name, std::uint64_t value, const std::string& object = "/");
  /// Writes a real number as attribute of `object`.
  void attribute(const std::string& name, double value, const std::string& object = "/");
  /// Writes a list of real numbers as attribute of `object`.
  void attribute(const std::string& name, const std::vector<double>& value, const std::string& object = "/");
  /// Returns whether the root group has this attribute.
  [[nodiscard]] bool has_attribute(const std::string& name) const;
  /// Returns a text attribute of the root group.
  [[nodiscard]] std::string text_attribute(const std::string& name) const;
  /// Returns a list of texts from an attribute of the root group.
  [[nodiscard]] std::vector<std::string> texts_attribute(const std::string& name) const;
  /// Returns an integer attribute of the root group.
  [[nodiscard]] std::uint64_t integer_attribute(const std::string& name) const;
  /// Returns a real attribute of the root group.
  [[nodiscard]] double real_attribute(const std::string& name) const;
  /// Returns a list of real numbers from an attribute of the root group.
  [[nodiscard]] std::vector<double> reals_attribute(const std::string& name) const;

  /// Throws InputError "<what> at <file>:<object> (<HDF5's reason>): <remedy>".
  [[noreturn]] void fail(const std::string& what, const std::string& object) const;
  /// Throws InputError as fail() does, with `why` as the reason.
  [[noreturn]] void fail_for(const std::string& why, const std::string& what,
                             const std::string& object) const;
  /// Returns the number of values in one row: the product of all dimensions except the first.
  static hsize_t row_size(const Shape& shape);

 private:
  /// Returns the number of values in `count` rows. Throws InputError if the file is too small for them.
  [[nodiscard]] std::size_t values_in(const std::string& object, hsize_t count, std::size_t bytes) const;
  [[noreturn]] void too_large(const std::string& object, std::uint64_t values, std::size_t bytes) const;
  void transfer(const std::string& object, hsize_t first, hsize_t count, hid_t type, void* in,
                const void* out) const;
  /// Returns the number of values in these rows of an array from open_apart. Throws InputError if the rows do
  /// not exist or have another type.
  [[nodiscard]] std::size_t values_apart(const std::string& object, hsize_t first, hsize_t count,
                                         const char* kind) const;
  void copy_apart(const std::string& object, hsize_t first, hsize_t count, void* to) const;
  template <class T>
  [[nodiscard]] const T& found(const std::string& name, const char* what) const;
  void put(const std::string& object, const std::string& name, hid_t file_type, hid_t memory_type,
           const Shape& shape, const void* data);
  [[nodiscard]] std::pair<Handle, hsize_t> find(const std::string& name) const;

  std::filesystem::path name_;
  Handle file_;
  std::shared_ptr<const Contents> contents_;  ///< content from open_apart
};

}  // namespace swingbank::mpi::store::h5
