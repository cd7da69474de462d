// Files appear completely or not at all, and a file or link at their temporary name is never written through.
#include "base/durable.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>

#include "base/json.hpp"
#include "base/problem.hpp"
#include "base/publish_hashed.hpp"
#include "base/sealed_file.hpp"
#include "base/write_file.hpp"
#include "tests/mpi/store/sample_shard.hpp"

namespace swingbank {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

template <class F>
std::string refusal(F action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.problems().front().sentence();
  }
  return "";
}

constexpr SealedKind kKind{"a test's file", "SWTEST01", "make it again"};
const std::vector<float> kNumbers(5000, 1.5F);

/// All functions that write a file.
struct Writer {
  const char* name;
  void (*write)(const fs::path&);
};
const Writer kWriters[] = {
    {"text", [](const fs::path& f) { write_text(f, std::string(20000, 'x')); }},
    {"file", [](const fs::path& f) { write_file(f, std::string(20000, 'x')); }},
    {"sealed",
     [](const fs::path& f) {
       write_sealed(kKind, f, {{"a", 1}}, {kNumbers});
     }},
    {"shard", [](const fs::path& f) { mpi::store::write_shard(f, test::sample_shard()); }},
    {"reserved",
     [](const fs::path& f) {
       reserve(f, 20000);
       publish(f);
     }},
    {"hashed",
     [](const fs::path& f) {
       reserve(f, 20000);
       publish_hashed(f);
     }},
};

class DurableFile : public ::testing::Test {
 protected:
  test::Folder folder;
  fs::path file = folder.path / "result";
  [[nodiscard]] int entries() const {
    return static_cast<int>(std::distance(fs::directory_iterator(folder.path), {}));
  }
};
class Durable : public DurableFile, public ::testing::WithParamInterface<Writer> {};

TEST_P(Durable, DoesNotFollowALinkAtTheTemporaryName) {
  const fs::path precious = folder.path / "precious";
  write_text(precious, "text");
  fs::create_symlink("precious", temporary_name(file));
  fs::create_symlink("precious", folder.path / "result.part");
  GetParam().write(file);
  EXPECT_EQ(read_text(precious), "text");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(file)));
  EXPECT_FALSE(fs::exists(fs::symlink_status(temporary_name(file))));
}

TEST_P(Durable, KeepsFilesHardLinkedToTheTemporaryName) {
  const fs::path precious = folder.path / "precious";
  write_text(precious, "text");
  fs::create_hard_link(precious, temporary_name(file));
  GetParam().write(file);
  EXPECT_EQ(read_text(precious), "text");
}

TEST_P(Durable, ReplacesAWholeFileAndLeavesNoTemporary) {
  write_text(file, "before");
  GetParam().write(file);
  EXPECT_GT(fs::file_size(file), 1000U);
  EXPECT_EQ(entries(), 1);
}

TEST_P(Durable, LeavesNoTemporaryFileWhenTargetIsAFolder) {
  fs::create_directories(file / "inside");
  const std::string said = refusal([&] { GetParam().write(file); });
  EXPECT_THAT(said, HasSubstr("at " + file.string()));
  EXPECT_THAT(said, HasSubstr("Is a directory"));
  EXPECT_EQ(entries(), 1);
}

INSTANTIATE_TEST_SUITE_P(Writers, Durable, ::testing::ValuesIn(kWriters),
                         [](const auto& which) { return which.param.name; });

/// Limits the size of every file of this process, in bytes, for its lifetime.
class SmallFiles {
 public:
  explicit SmallFiles(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallFiles() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  SmallFiles(const SmallFiles&) = delete;
  SmallFiles& operator=(const SmallFiles&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(DurableFile, KeepsTheOldFileWhenAWriteFails) {
  write_text(file, "before");
  for (const Writer& w : {kWriters[0], kWriters[1], kWriters[2]}) {
    const SmallFiles limit(4096);
    EXPECT_THAT(refusal([&] { w.write(file); }), HasSubstr("File too large")) << w.name;
  }
  EXPECT_EQ(read_text(file), "before");
  EXPECT_EQ(entries(), 1);
}

TEST_F(DurableFile, RemovesAnUnpublishedFile) {
  {
    NewFile f(file);
    f.write("half", 4);
    EXPECT_EQ(entries(), 1);
  }
  EXPECT_EQ(entries(), 0);
}

TEST_F(DurableFile, HashTakenDuringTheFlushMatchesTheFile) {
  reserve(file, 3 << 20);
  {
    std::ofstream out(temporary_name(file), std::ios::binary);
    for (int i = 0; i < 300'000; ++i) out << i;
  }
  const std::string hash = publish_hashed(file);
  EXPECT_EQ(hash, hash_of_file(file));
  EXPECT_EQ(entries(), 1);
  EXPECT_THAT(refusal([&] { publish_hashed(folder.path / "none"); }), HasSubstr("No such file"));
}

TEST_F(DurableFile, CreatesMissingFolders) {
  write_file(folder.path / "deep" / "a.txt", "one");
  EXPECT_EQ(read_text(folder.path / "deep" / "a.txt"), "one");
  EXPECT_THAT(refusal([&] { write_file(folder.path / "deep" / "a.txt" / "c", "x"); }),
              HasSubstr("a file has this name"));
}

}  // namespace
}  // namespace swingbank
