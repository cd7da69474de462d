#include "base/input_file.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

namespace swingbank {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// An empty working folder and a folder of examples beside it; both are removed after the test.
class InputFile : public ::testing::Test {
 protected:
  InputFile() : before_(fs::current_path()) {
    std::string pattern = (fs::temp_directory_path() / "swingbank-test-XXXXXX").string();
    root_ = fs::canonical(::mkdtemp(pattern.data()));
    fs::create_directories(root_ / "share/configs/plants");
    std::ofstream(root_ / "share/configs/plants/one.toml") << "a = 1\n";
    fs::create_directory(root_ / "here");
    fs::current_path(root_ / "here");
  }
  ~InputFile() override {
    fs::current_path(before_);
    fs::remove_all(root_);
  }
  [[nodiscard]] std::string sentence(const fs::path& file) const {
    return unreadable(file, "no plant file", "give another", root_ / "share/configs").sentence();
  }
  [[nodiscard]] fs::path root() const { return root_; }

 private:
  fs::path before_, root_;
};

TEST_F(InputFile, MissingFileReportsTheFoldersSearched) {
  EXPECT_EQ(sentence("mine.toml"), "no plant file at mine.toml (there is no such file; searched in " +
                                       (root() / "here").string() + "): give another");
  EXPECT_EQ(sentence("/nowhere/mine.toml"),
            "no plant file at /nowhere/mine.toml (there is no such file): give another");
}

TEST_F(InputFile, MissingFileNamesTheExampleOfThatPath) {
  const std::string example = (root() / "share/configs/plants/one.toml").string();
  for (const char* named : {"configs/plants/one.toml", "plants/one.toml"})
    EXPECT_THAT(sentence(named),
                AllOf(HasSubstr(example), HasSubstr("cp -r " + (root() / "share/configs").string() + " .")));
  EXPECT_THAT(sentence("configs/plants/two.toml"), Not(HasSubstr("example")));
}

TEST_F(InputFile, ReportsAPatternWithoutMatchingFiles) {
  EXPECT_THAT(sentence("configs/plants/o*.toml"),
              AllOf(HasSubstr("no file matches this pattern"),
                    HasSubstr((root() / "share/configs/plants").string())));
  EXPECT_THAT(sentence("o*.toml"),
              AllOf(HasSubstr("no file matches this pattern"), HasSubstr("give another")));
}

TEST_F(InputFile, ReportsUnreadableFileAsExisting) {
  std::ofstream("empty.toml").flush();
  EXPECT_THAT(sentence("empty.toml"), HasSubstr("(it is empty)"));
  EXPECT_THAT(sentence("."), HasSubstr("(it is a folder)"));
  // A local file takes precedence over the example of the same name, even if it is invalid.
  fs::create_directories("plants");
  std::ofstream("plants/one.toml").flush();
  EXPECT_THAT(sentence("plants/one.toml"), AllOf(HasSubstr("(it is empty)"), Not(HasSubstr("example"))));
}

TEST_F(InputFile, ReadsBytesAndRefusesTheRest) {
  const std::string bytes("a\0\r\nb", 5);
  std::ofstream("some.bin", std::ios::binary) << bytes;
  EXPECT_EQ(read_input("some.bin", "nothing", "nothing"), bytes);
  std::ofstream("empty").flush();
  for (const char* file : {"empty", "gone", "."}) EXPECT_THROW((void)read_input(file, "w", "r"), InputError);
}

TEST_F(InputFile, RefusesDevicesAndPipes) {
  ASSERT_EQ(::mkfifo("pipe", 0600), 0);
  EXPECT_THAT(sentence("pipe"), HasSubstr("(it is a pipe or a device"));
  for (const char* file : {"pipe", "/dev/zero"}) EXPECT_THROW((void)read_input(file, "w", "r"), InputError);
}

TEST_F(InputFile, BuildFolderHasTheSourcesExamples) {
  EXPECT_EQ(example_configs(), fs::canonical(SWINGBANK_SOURCE "/configs"));
}

}  // namespace
}  // namespace swingbank
