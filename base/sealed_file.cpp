#include "base/sealed_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "base/durable.hpp"
#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/until_done.hpp"

namespace swingbank {
namespace {
using nlohmann::json;

struct Hash {
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state{XXH3_createState(), XXH3_freeState};
  Hash() { XXH3_64bits_reset(state.get()); }
  void add(const void* data, std::size_t bytes) { XXH3_64bits_update(state.get(), data, bytes); }
  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits_digest(state.get()); }
};

/// Buffered reader of a file. A disk error throws InputError. Throws Unusable if the file is truncated.
class Input {
 public:
  explicit Input(const std::filesystem::path& file) : file_(file), buffer_(std::size_t{1} << 16) {
    fd_ = until_done([&] { return ::open(file.c_str(), O_RDONLY | O_CLOEXEC); });
    if (fd_ < 0 && errno != ENOENT) raise_file_error(file_, errno, "cannot read the file");
  }
  ~Input() {
    if (fd_ >= 0) ::close(fd_);
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  [[nodiscard]] bool is_there() const { return fd_ >= 0; }
  [[nodiscard]] std::uint64_t length() const {
    struct stat status {};
    if (::fstat(fd_, &status) != 0) raise_file_error(file_, errno, "cannot read the file");
    return static_cast<std::uint64_t>(status.st_size);
  }
  void rewind() {
    if (::lseek(fd_, 0, SEEK_SET) != 0) raise_file_error(file_, errno, "cannot read the file");
    at_ = filled_ = 0;
  }
  void get(void* data, std::size_t bytes) {
    for (char* to = static_cast<char*>(data); bytes > 0;) {
      if (at_ == filled_) fill();
      const std::size_t n = std::min(bytes, filled_ - at_);
      std::memcpy(to, buffer_.data() + at_, n);
      to += n, at_ += n, bytes -= n;
    }
  }

 private:
  void fill() {
    const ssize_t n = until_done([&] { return ::read(fd_, buffer_.data(), buffer_.size()); });
    if (n < 0) raise_file_error(file_, errno, "cannot read the file");
    if (n == 0) throw Unusable{"the file is truncated"};
    at_ = 0, filled_ = static_cast<std::size_t>(n);
  }
  const std::filesystem::path& file_;
  std::vector<char> buffer_;
  std::size_t at_ = 0, filled_ = 0;
  int fd_ = -1;
};

/// Verifies magic bytes and checksum before the content is used. Throws Unusable if they are wrong.
void require_seal(Input& in, std::uint64_t length, const SealedKind& kind) {
  std::string magic(std::strlen(kind.magic), '\0');
  if (length < magic.size()) throw Unusable{"the file is truncated"};
  in.get(magic.data(), magic.size());
  if (magic != kind.magic)
    throw Unusable{"it is not a " + std::string(kind.what) + " (wrong file signature)"};
  in.rewind();
  Hash hash;
  std::uint64_t seal = 0;
  if (length < magic.size() + sizeof seal) throw Unusable{"the file is truncated"};
  std::vector<char> piece(std::size_t{1} << 16);
  for (std::uint64_t left = length - sizeof seal; left > 0;) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(left, piece.size()));
    in.get(piece.data(), n);
    hash.add(piece.data(), n);
    left -= n;
  }
  in.get(&seal, sizeof seal);
  if (seal != hash.value()) throw Unusable{"its checksum is wrong"};
  in.rewind();
}

/// Reads the file from its magic bytes to its last array. Throws Unusable if its structure is invalid.
void read_all(Input& in, std::uint64_t length, const SealedKind& kind,
              const std::function<void(const json&, std::size_t)>& start, const PlaceArray& place) {
  const auto get_size = [&] {
    std::uint64_t n = 0;
    in.get(&n, sizeof n);
    return n;
  };
  std::string magic(std::strlen(kind.magic), '\0');
  in.get(magic.data(), magic.size());
  const std::uint64_t header_length = get_size();
  if (header_length > length) throw Unusable{"its header is damaged"};
  std::string text(header_length, '\0');
  in.get(text.data(), text.size());
  const json header = json::parse(text, nullptr, false);
  if (!header.is_object()) throw Unusable{"its header is damaged"};
  const std::uint64_t arrays = get_size();
  if (arrays > length / sizeof(std::uint64_t)) throw Unusable{"the file is truncated"};
  start(header, arrays);
  for (std::size_t i = 0; i < arrays; ++i) {
    const std::uint64_t size = get_size();
    if (size > length / sizeof(float)) throw Unusable{"the file is truncated"};
    const std::span<float> to = place(i, size);
    in.get(to.data(), to.size_bytes());
  }
}
}  // namespace

void write_sealed(const SealedKind& kind, const std::filesystem::path& file, const json& header,
                  const std::vector<std::span<const float>>& arrays) {
  Hash hash;
  NewFile out(file, std::string(kind.what) + " cannot be written");
  const auto put = [&](const void* data, std::size_t bytes) {
    hash.add(data, bytes);
    out.write(data, bytes);
  };
  const auto put_size = [&](std::uint64_t n) { put(&n, sizeof n); };
  const std::string text = header.dump();
  put(kind.magic, std::strlen(kind.magic));
  put_size(text.size());
  put(text.data(), text.size());
  put_size(arrays.size());
  for (const auto& a : arrays) {
    put_size(a.size());
    put(a.data(), a.size_bytes());
  }
  const std::uint64_t seal = hash.value();
  out.write(&seal, sizeof seal);
  out.publish();
}

bool read_sealed(const SealedKind& kind, const std::filesystem::path& file,
                 const std::function<void(const json&, std::size_t)>& start, const PlaceArray& place) {
  Input in(file);
  if (!in.is_there()) return false;
  try {
    const std::uint64_t length = in.length();
    require_seal(in, length, kind);
    read_all(in, length, kind, start, place);
  } catch (const Unusable& e) {
    throw InputError({std::string(kind.what) + " cannot be used", file.string(), e.why, kind.remedy});
  }
  return true;
}

}  // namespace swingbank
