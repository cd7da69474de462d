#include "mpi/store/hdf5_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include "base/durable.hpp"
#include "base/input_file.hpp"
#include "base/problem.hpp"
#include "base/read_apart.hpp"
#include "mpi/store/hdf5_apart.hpp"

namespace swingbank::mpi::store::h5 {

namespace {

constexpr const char* kRemedy = "if the file is damaged, delete it and repeat the command that wrote it";

/// Returns the innermost message on HDF5's error stack, which is the cause. Clears the stack.
std::string reason() {
  std::string text = "no reason given by HDF5";
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned n, const H5E_error2_t* e, void* out) -> herr_t {
        if (n == 0 && e->desc != nullptr) *static_cast<std::string*>(out) = e->desc;
        return 0;
      },
      &text);
  H5Eclear2(H5E_DEFAULT);
  return text;
}

/// Returns the errno value in a message of HDF5's driver ("errno = 28"), or the value equivalent to an MPI-IO
/// error in the message; 0 if the message has neither.
int system_error(const std::string& why) {
  constexpr std::string_view kErrno = "errno = ";
  if (const auto at = why.find(kErrno); at != std::string::npos)
    return std::atoi(why.c_str() + at + kErrno.size());
  constexpr std::pair<std::string_view, int> kOfMpi[] = {
      {"ERR_NO_SPACE", ENOSPC}, {"ERR_NO_SUCH_FILE", ENOENT}, {"ERR_QUOTA", EDQUOT},
      {"ERR_ACCESS", EACCES},   {"ERR_READ_ONLY", EROFS},     {"ERR_IO", EIO}};
  for (const auto& [name, error] : kOfMpi)
    if (why.find(name) != std::string::npos) return error;
  return 0;
}

void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

Handle untimed(hid_t list_class) {
  Handle list(H5Pcreate(list_class), H5Pclose);
  H5Pset_obj_track_times(list.get(), false);
  return list;
}

Handle space_of(const Shape& shape) {
  return {shape.empty() ? H5Screate(H5S_SCALAR)
                        : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
          H5Sclose};
}

Handle string_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

}  // namespace

std::recursive_mutex& lock() {
  static std::recursive_mutex mutex;
  return mutex;
}

namespace {
/// Adds the text of errno to an unspecific message of HDF5, because MPI-IO does not always report the cause.
std::string with_system(std::string why, int last) {
  const bool vague =
      why == "file write failed" || why == "file read failed" || why.find("ERR_OTHER") != why.npos;
  if (last != 0 && vague) why += std::string("; the system: ") + std::strerror(last);
  return why;
}
std::string first_failed_close;  // empty: none or already reported; guarded by lock()
}  // namespace

void note_failed_close() {
  const int last = errno;
  const std::string why = with_system(reason(), last);
  if (!close_failed.exchange(true)) first_failed_close = why;
}

std::string unreported_failed_close() { return std::exchange(first_failed_close, {}); }

void File::fail(const std::string& what, const std::string& object) const {
  const int last = errno;
  fail_for(with_system(reason(), last), what, object);
}

void File::fail_for(const std::string& why, const std::string& what, const std::string& object) const {
  const std::string where = name_.string() + (object.empty() ? "" : ":" + object);
  if (const int error = system_error(why)) raise_file_error(where, error, what);
  throw InputError({what, where, why, kRemedy});
}

File File::open(const std::filesystem::path& file) {
  silence();
  File f;
  f.name_ = file;
  if (!std::filesystem::exists(file))
    throw InputError(unreadable(file, "cannot open the HDF5 file", "check the path"));
  f.file_ = Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!f.file_) f.fail("cannot open the HDF5 file", "");
  return f;
}

File File::open_apart(const std::filesystem::path& file, const std::vector<std::string>& names) {
  File f;
  f.name_ = file;
  if (!std::filesystem::exists(file))
    throw InputError(unreadable(file, "cannot open the HDF5 file", "check the path"));
  f.contents_ = std::make_shared<const Contents>(Contents::parse(read_apart("hdf5", file, names), file));
  return f;
}

File File::create(const std::filesystem::path& file, hid_t access) {
  silence();
  File f;
  f.name_ = file;
  const Handle properties = untimed(H5P_FILE_CREATE);
  errno = 0;
  f.file_ = Handle(
      H5Fcreate(file.c_str(), H5F_ACC_TRUNC, properties.get(), access < 0 ? H5P_DEFAULT : access), H5Fclose);
  if (!f.file_) f.fail("cannot create the HDF5 file", "");
  return f;
}

void File::close() {
  errno = 0;
  if (file_.reset() && !close_failed) return;
  // The cause of a failed close is reported once; later files fail without it.
  const std::string why = unreported_failed_close();
  fail_for(why.empty() ? "another HDF5 object could not be closed" : why, "cannot complete the HDF5 file",
           "");
}

template <class T>
const T& File::found(const std::string& name, const char* what) const {
  const auto* value = contents_->find(name);
  const T* it = value == nullptr ? nullptr : std::get_if<T>(value);
  if (it == nullptr)
    throw InputError({what, name_.string() + ":" + name, "the file does not contain it", kRemedy});
  return *it;
}

std::size_t File::values_apart(const std::string& object, hsize_t first, hsize_t count,
                               const char* kind) const {
  const auto& a = found<Contents::Array>(object, "cannot open the array");
  const auto refuse = [&](const char* what, const std::string& why) {
    throw InputError({what, name_.string() + ":" + object, why, kRemedy});
  };
  if (a.kind != kind) refuse("an array of another type", "it holds " + a.kind + ", not " + kind);
  if (count == 0) return 0;
  if (a.shape.empty() || count > a.shape[0] || first > a.shape[0] - count)
    refuse("missing rows", "the array has " + std::to_string(a.shape.empty() ? 0 : a.shape[0]) + " rows");
  return count * row_size(Shape(a.shape.begin(), a.shape.end()));
}

void File::copy_apart(const std::string& object, hsize_t first, hsize_t count, void* to) const {
  const auto& a = found<Contents::Array>(object, "cannot open the array");
  if (count == 0 || a.bytes.empty()) return;
  const std::size_t row = a.bytes.size() / a.shape[0];
  std::memcpy(to, a.bytes.data() + first * row, count * row);
}

bool File::has(const std::string& object) const {
  if (contents_) return contents_->find(object) != nullptr;
  return H5Lexists(file_.get(), object.c_str(), H5P_DEFAULT) > 0;
}

std::string File::kind(const std::string& object) const {
  if (contents_) return found<Contents::Array>(object, "cannot open the array").kind;
  const Handle set(H5Dopen2(file_.get(), object.c_str(), H5P_DEFAULT), H5Dclose);
  if (!set) fail("cannot open the array", object);
  const Handle type(H5Dget_type(set.get()), H5Tclose);
  const auto kind_class = H5Tget_class(type.get());
  const std::string bytes = std::to_string(H5Tget_size(type.get()));
  std::string kind;
  if (kind_class == H5T_FLOAT) kind = "f" + bytes;
  if (kind_class == H5T_INTEGER) kind = (H5Tget_sign(type.get()) == H5T_SGN_NONE ? "u" : "i") + bytes;
  for (const char* known : {"f4", "f8", "u8", "i4", "i2", "u1"})
    if (kind == known) return kind;
  return {};
}

Shape File::shape(const std::string& object) const {
  if (contents_) {
    const auto& a = found<Contents::Array>(object, "cannot open the array");
    return {a.shape.begin(), a.shape.end()};
  }
  const Handle set(H5Dopen2(file_.get(), object.c_str(), H5P_DEFAULT), H5Dclose);
  if (!set) fail("cannot open the array", object);
  const Handle space(H5Dget_space(set.get()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) fail("cannot read the array's shape", object);
  Shape s(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), s.data(), nullptr);
  return s;
}

void File::too_large(const std::string& object, std::uint64_t values, std::size_t bytes) const {
  throw InputError({"an array too large to read", name_.string() + ":" + object,
                    std::to_string(values) + " values of " + std::to_string(bytes) +
                        " bytes exceed the size of the file or the memory of this machine",
                    kRemedy});
}

std::size_t File::values_in(const std::string& object, hsize_t count, std::size_t bytes) const {
  constexpr std::uint64_t kDensest = 1032;  // highest compression ratio of zlib, far above other filters
  const Shape extent = shape(object);
  std::uint64_t values = count, most = kDensest * std::filesystem::file_size(name_) / bytes;
  for (std::size_t i = 1; i < extent.size(); ++i)
    if (__builtin_mul_overflow(values, extent[i], &values)) too_large(object, ~std::uint64_t{0}, bytes);
  if (values > most) too_large(object, values, bytes);
  return values;
}

hsize_t File::row_size(const Shape& shape) {
  hsize_t n = 1;
  for (std::size_t i = 1; i < shape.size(); ++i) n *= shape[i];
  return n;
}

void File::create_group(const std::string& name) {
  const Handle properties = untimed(H5P_GROUP_CREATE);
  const Handle group(H5Gcreate2(file_.get(), name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                     H5Gclose);
  if (!group) fail("cannot create the group", name);
}

void File::create(const std::string& object, hid_t file_type, const Shape& shape) {
  const Handle space = space_of(shape), properties = untimed(H5P_DATASET_CREATE);
  H5Pset_fill_time(properties.get(), H5D_FILL_TIME_NEVER);  // every row is written later
  H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY);
  const Handle set(H5Dcreate2(file_.get(), object.c_str(), file_type, space.get(), H5P_DEFAULT,
                              properties.get(), H5P_DEFAULT),
                   H5Dclose);
  if (!set) fail("cannot create the array", object);
}

void File::create_virtual(const std::string& object, const File& example, const std::vector<Part>& parts) {
  Shape shape = example.shape(object);
  shape[0] = 0;
  for (const Part& p : parts) shape[0] += p.count;
  const Handle space = space_of(shape), properties = untimed(H5P_DATASET_CREATE);
  Shape start(shape.size(), 0), piece = shape;
  for (const Part& p : parts) {
    piece[0] = p.count;
    const Handle source = space_of(piece);
    if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, piece.data(), nullptr) < 0 ||
        H5Pset_virtual(properties.get(), space.get(), p.file.c_str(), p.object.c_str(), source.get()) < 0)
      fail("cannot describe the virtual array", object);
    start[0] += p.count;
  }
  const Handle like(H5Dopen2(example.file_.get(), object.c_str(), H5P_DEFAULT), H5Dclose);
  const Handle type(like ? H5Dget_type(like.get()) : -1, H5Tclose);
  H5Sselect_all(space.get());
  const Handle set(H5Dcreate2(file_.get(), object.c_str(), type.get(), space.get(), H5P_DEFAULT,
                              properties.get(), H5P_DEFAULT),
                   H5Dclose);
  if (!set) fail("cannot create the virtual array", object);
}

void File::transfer(const std::string& object, hsize_t first, hsize_t count, hid_t type, void* in,
                    const void* out) const {
  if (count == 0) return;
  const Handle set(H5Dopen2(file_.get(), object.c_str(), H5P_DEFAULT), H5Dclose);
  if (!set) fail("cannot open the array", object);
  const Handle space(H5Dget_space(set.get()), H5Sclose);
  Shape extent = shape(object), start(extent.size(), 0);
  if (extent.empty() || first + count > extent[0]) {
    throw InputError({"missing rows " + std::to_string(first) + " to " + std::to_string(first + count - 1),
                      name_.string() + ":" + object,
                      "the array has " + std::to_string(extent.empty() ? 0 : extent[0]) + " rows",
                      "request existing rows"});
  }
  start[0] = first;
  extent[0] = count;
  H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr);
  const Handle memory = space_of(extent);
  errno = 0;
  const herr_t result = in != nullptr
                            ? H5Dread(set.get(), type, memory.get(), space.get(), H5P_DEFAULT, in)
                            : H5Dwrite(set.get(), type, memory.get(), space.get(), H5P_DEFAULT, out);
  if (result < 0) fail(in != nullptr ? "cannot read the array" : "cannot write the array", object);
}

void File::put(const std::string& object, const std::string& name, hid_t file_type, hid_t memory_type,
               const Shape& shape, const void* data) {
  const Handle space = space_of(shape);
  const Handle a(H5Acreate_by_name(file_.get(), object.c_str(), name.c_str(), file_type, space.get(),
                                   H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                 H5Aclose);
  const bool nothing = !shape.empty() && shape[0] == 0;
  if (!a || (!nothing && H5Awrite(a.get(), memory_type, data) < 0))
    fail("cannot write the attribute", object + "@" + name);
}

void File::attribute(const std::string& name, const std::string& value, const std::string& object) {
  const Handle type = string_type();
  const char* text = value.c_str();
  put(object, name, type.get(), type.get(), {}, &text);
}

void File::attribute(const std::string& name, const std::vector<std::string>& value,
                     const std::string& object) {
  const Handle type = string_type();
  std::vector<const char*> texts;
  for (const auto& v : value) texts.push_back(v.c_str());
  put(object, name, type.get(), type.get(), {texts.size()}, texts.data());
}

void File::attribute(const std::string& name, std::uint64_t value, const std::string& object) {
  put(object, name, Type<std::uint64_t>::file(), Type<std::uint64_t>::memory(), {}, &value);
}
void File::attribute(const std::string& name, double value, const std::string& object) {
  put(object, name, Type<double>::file(), Type<double>::memory(), {}, &value);
}
void File::attribute(const std::string& name, const std::vector<double>& value, const std::string& object) {
  put(object, name, Type<double>::file(), Type<double>::memory(), {value.size()}, value.data());
}

std::pair<Handle, hsize_t> File::find(const std::string& name) const {
  Handle a(H5Aopen_by_name(file_.get(), "/", name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!a) fail("cannot read the attribute", "/@" + name);
  const Handle space(H5Aget_space(a.get()), H5Sclose);
  const hssize_t n = H5Sget_simple_extent_npoints(space.get());
  constexpr hssize_t kMost = 1 << 20;  // rejects damaged files; real ones have a value per parameter or plant
  if (n < 0 || n > kMost) fail("cannot read the attribute", "/@" + name);
  return {std::move(a), static_cast<hsize_t>(n)};
}

std::vector<std::string> File::texts_attribute(const std::string& name) const {
  if (contents_) return found<std::vector<std::string>>("@" + name, "cannot read the attribute");
  const auto [a, n] = find(name);
  const Handle type = string_type(), space(H5Aget_space(a.get()), H5Sclose);
  std::vector<char*> texts(n, nullptr);
  if (n > 0 && H5Aread(a.get(), type.get(), texts.data()) < 0) fail("cannot read the attribute", "/@" + name);
  std::vector<std::string> values;
  for (const char* t : texts) values.emplace_back(t == nullptr ? "" : t);
  if (n > 0) H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, texts.data());
  return values;
}

bool File::has_attribute(const std::string& name) const {
  if (contents_) return contents_->find("@" + name) != nullptr;
  return H5Aexists_by_name(file_.get(), "/", name.c_str(), H5P_DEFAULT) > 0;
}
std::string File::text_attribute(const std::string& name) const {
  const auto values = texts_attribute(name);
  if (values.size() != 1) fail("the attribute is not one text", "/@" + name);
  return values[0];
}

std::uint64_t File::integer_attribute(const std::string& name) const {
  if (contents_) return found<std::uint64_t>("@" + name, "cannot read the attribute");
  const auto [a, n] = find(name);
  std::uint64_t value = 0;
  if (n != 1 || H5Aread(a.get(), Type<std::uint64_t>::memory(), &value) < 0)
    fail("the attribute is not one integer", "/@" + name);
  return value;
}

std::vector<double> File::reals_attribute(const std::string& name) const {
  if (contents_) return found<std::vector<double>>("@" + name, "cannot read the attribute");
  const auto [a, n] = find(name);
  std::vector<double> values(n);
  if (n > 0 && H5Aread(a.get(), Type<double>::memory(), values.data()) < 0)
    fail("cannot read the attribute", "/@" + name);
  return values;
}

double File::real_attribute(const std::string& name) const {
  const auto values = reals_attribute(name);
  if (values.size() != 1) fail("the attribute is not one number", "/@" + name);
  return values[0];
}

}  // namespace swingbank::mpi::store::h5
