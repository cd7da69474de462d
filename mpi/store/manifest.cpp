#include "mpi/store/manifest.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <charconv>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include "base/durable.hpp"

namespace swingbank::mpi::store {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kManifestFormat = "swingbank-manifest-1\n", kManifestSum = "sum ";

/// Returns the names and lengths of the journals, one journal per line. Even a dataset with many shards has
/// few journals.
std::string journals_now(const fs::path& folder) {
  std::string text;
  for (const auto& file : journals_of(folder))
    text += fmt::format("journal {} {}\n", file.filename().string(), fs::file_size(file));
  return text;
}

std::string counts_text(const std::map<std::string, std::uint64_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts)
    text += fmt::format("{}{}={}", text.empty() ? "" : ",", name, count);
  return text.empty() ? "-" : text;
}

/// Splitter of the manifest's text into words.
class ManifestWords {
 public:
  explicit ManifestWords(std::string_view text) : left_(text) {}
  std::string_view next(char end) {
    const auto at = left_.find(end);
    if (at == std::string_view::npos) throw std::runtime_error("a line that ends too early");
    const auto word = left_.substr(0, at);
    left_.remove_prefix(at + 1);
    return word;
  }
  [[nodiscard]] bool empty() const { return left_.empty(); }

 private:
  std::string_view left_;
};

std::uint64_t whole_number(std::string_view word) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) throw std::runtime_error("not an integer");
  return value;
}

std::map<std::string, std::uint64_t> counts_of(std::string_view text) {
  std::map<std::string, std::uint64_t> counts;
  if (text == "-") return counts;
  const std::string all = std::string(text) + ",";
  for (ManifestWords words(all); !words.empty();) {
    const std::string_view word = words.next(',');
    const auto equals = word.find('=');
    if (equals == std::string_view::npos) throw std::runtime_error("no count");
    counts.emplace(word.substr(0, equals), whole_number(word.substr(equals + 1)));
  }
  return counts;
}

JournalLine manifest_line(std::string_view text) {
  const std::string whole = std::string(text) + " ";
  ManifestWords w(whole);
  JournalLine l;
  l.shard = whole_number(w.next(' '));
  l.file = w.next(' ');
  l.draws = whole_number(w.next(' '));
  l.rows = whole_number(w.next(' '));
  l.bytes = whole_number(w.next(' '));
  l.hash = w.next(' ');
  l.file_hash = w.next(' ');
  l.outcomes = counts_of(w.next(' '));
  l.operating_points = counts_of(w.next(' '));
  return l;
}

[[noreturn]] void damaged_manifest(const fs::path& file, const std::string& why) {
  throw InputError(
      {"damaged manifest", file.string(), why,
       "delete the file: the journals contain the same data, and generate writes the file again"});
}

/// Returns the text between format line and checksum. Throws InputError if the checksum is wrong.
std::string_view unsealed(const fs::path& file, std::string_view text) {
  const auto at = text.rfind(kManifestSum);
  if (at == std::string_view::npos) damaged_manifest(file, "it has no checksum");
  const auto body = text.substr(0, at);
  if (text.substr(at + kManifestSum.size()) != hex(XXH3_64bits(body.data(), body.size())) + "\n")
    damaged_manifest(file, "its checksum is wrong");
  if (!body.starts_with(kManifestFormat))
    damaged_manifest(file, "it does not begin with " + std::string(kManifestFormat));
  return body.substr(kManifestFormat.size());
}

}  // namespace

void write_manifest(const fs::path& folder, const std::vector<JournalLine>& lines) {
  std::string text = std::string(kManifestFormat) + journals_now(folder) + "\n";
  for (const JournalLine& l : lines)
    fmt::format_to(std::back_inserter(text), "{} {} {} {} {} {} {} {} {}\n", l.shard, l.file, l.draws, l.rows,
                   l.bytes, l.hash, l.file_hash, counts_text(l.outcomes), counts_text(l.operating_points));
  text += std::string(kManifestSum) + hex(XXH3_64bits(text.data(), text.size())) + "\n";
  write_text(folder / kManifestFile, text);
}

std::optional<std::vector<JournalLine>> read_manifest(const fs::path& folder) {
  const fs::path file = folder / kManifestFile;
  if (!fs::exists(file)) return std::nullopt;
  const std::string text = read_text(file);
  std::string_view body = unsealed(file, text);
  const std::string journals = journals_now(folder) + "\n";
  if (!body.starts_with(journals)) return std::nullopt;
  body.remove_prefix(journals.size());
  std::vector<JournalLine> lines;
  try {
    for (ManifestWords words(body); !words.empty();) lines.push_back(manifest_line(words.next('\n')));
  } catch (const std::runtime_error& e) {
    damaged_manifest(file, e.what());
  }
  return lines;
}

}  // namespace swingbank::mpi::store
