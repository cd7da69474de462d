// No output replaces an input, under any spelling of its path.
#include "base/inputs_kept.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "base/durable.hpp"
#include "base/input_file.hpp"
#include "base/output_folder.hpp"
#include "base/problem.hpp"

namespace swingbank {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class InputsKept : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / "inputs_kept" /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "own");
    fs::current_path(folder_);
    put("own/model.toml", "model");
    keep_inputs();
  }
  void TearDown() override {
    keep_inputs(false);
    fs::current_path("/");
  }
  static void put(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
  static void read(const fs::path& file) { read_input(file, "no file", "give one"); }
  static std::string refusal(const std::vector<Output>& outputs) {
    try {
      require_inputs_kept(outputs);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(InputsKept, RefusesTheInputUnderEverySpelling) {
  read("own/model.toml");
  fs::create_symlink("own", "link");
  fs::create_symlink("own/model.toml", "other.toml");
  fs::create_hard_link("own/model.toml", "hard.toml");
  for (const fs::path& file :
       {fs::path("own/model.toml"), fs::path("./own//model.toml"), folder_ / "own" / "model.toml",
        fs::path("own/../own/model.toml"), fs::path("new/../own/model.toml"), fs::path("link/model.toml"),
        fs::path("other.toml"), fs::path("hard.toml")})
    EXPECT_THAT(refusal({{file, "--out"}}),
                AllOf(HasSubstr("output " + file.string() + " is an input at --out ("), HasSubstr("): give")))
        << file;
  EXPECT_EQ(refusal({{"own/model.dyr", "--out"}, {"model.toml", "--pdf"}}), "");
}

TEST_F(InputsKept, RefusesAnInputReadThroughALink) {
  fs::create_symlink("own/model.toml", "other.toml");
  read("other.toml");
  EXPECT_THAT(refusal({{"own/model.toml", "--out"}}), HasSubstr("is an input"));
}

TEST_F(InputsKept, RefusesTwoOutputsOfOneName) {
  EXPECT_THAT(refusal({{"own/report.html", "--out"}, {"own/./report.html", "--pdf"}}),
              HasSubstr("is named twice at --pdf (it is also written for --out)"));
}

TEST_F(InputsKept, NeverOverwritesAnInput) {
  read("own/model.toml");
  EXPECT_THROW(write_text("own/model.toml", "another"), InputError);
  reserve("own/model.toml", 0);
  EXPECT_THROW(publish("own/model.toml"), InputError);
  EXPECT_EQ(read_text("own/model.toml"), "model");
  EXPECT_EQ(std::distance(fs::directory_iterator("own"), {}), 1) << "a temporary file is left";
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::ranges::sort(names);
  return names;
}

using OutputFolderTest = InputsKept;

TEST_F(OutputFolderTest, RemovesResultsOfAnEarlierRunOnly) {
  const auto run = [](const std::vector<std::string>& names) {
    OutputFolder results("out", "compare", names);
    for (const auto& name : names) write_text(results.file(name), name);
    results.finish();
  };
  run({"playback-a.csv", "playback-b.csv", "compare.json"});
  put("out/playback-mine.csv", "mine");
  put("out/playback-b.csv", "edited");
  run({"playback-c.csv", "compare.json"});
  EXPECT_EQ(names_in("out"), (std::vector<std::string>{".swingbank-compare", "compare.json", "playback-b.csv",
                                                       "playback-c.csv", "playback-mine.csv"}));
  {
    OutputFolder results("out", "compare", {"interrupted.json"});
    write_text(results.file("interrupted.json"), "");
    results.finish(OutputFolder::Earlier::stay);
  }
  EXPECT_TRUE(fs::exists("out/playback-c.csv"));
  run({"compare.json"});
  EXPECT_EQ(names_in("out"), (std::vector<std::string>{".swingbank-compare", "compare.json", "playback-b.csv",
                                                       "playback-mine.csv"}));
}

TEST_F(OutputFolderTest, RemovesResultsOfAnUnfinishedRun) {
  {
    OutputFolder results("out", "compare", {"compare.json", "playback.csv"});
    write_text(results.file("playback.csv"), "half");
  }
  EXPECT_FALSE(fs::exists("out"));
  {
    OutputFolder results("out", "compare", {"compare.json", "playback.csv"});
    for (const char* name : {"compare.json", "playback.csv"}) write_text(results.file(name), "earlier");
    results.finish();
  }
  {
    OutputFolder results("out", "compare", {"compare.json", "playback.csv"});
    write_text(results.file("playback.csv"), "half");
    results.file("compare.json");  // the disk is full before it is written
  }
  EXPECT_EQ(names_in("out"), (std::vector<std::string>{".swingbank-compare", "compare.json"}));
}

TEST_F(OutputFolderTest, RefusesAnInputThatIsAStaleResult) {
  {
    OutputFolder results("out", "compare", {"playback-a.csv"});
    write_text(results.file("playback-a.csv"), "a");
    results.finish();
  }
  read("out/playback-a.csv");
  EXPECT_THROW(OutputFolder("out", "compare", {"compare.json"}), InputError);
  EXPECT_EQ(read_text("out/playback-a.csv"), "a");
}

TEST_F(OutputFolderTest, RefusesToReplaceResultsOfAnotherCommand) {
  {
    OutputFolder results("out", "add", {"model.toml", "report.html", "add.json"});
    for (const char* name : {"model.toml", "report.html"}) write_text(results.file(name), "add");
    results.finish();
  }
  try {
    const OutputFolder results("out", "calibrate", {"model.toml", "report.html", "add.json"});
    ADD_FAILURE() << "results of another command are replaced";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("model.toml of 'swingbank add' at --out out"),
                      HasSubstr("report.html of 'swingbank add'"), Not(HasSubstr("add.json of"))));
  }
  EXPECT_NO_THROW(OutputFolder("out", "compare", {"compare.json"}));
  EXPECT_NO_THROW(OutputFolder("out", "add", {"report.html"}));
}

TEST_F(OutputFolderTest, IsLockedByOneCommandAndLeavesNoLockFile) {
  {
    const OutputFolder first("new/out", "calibrate", {"model.toml"});
    try {
      const OutputFolder second("new/out", "add", {"model.toml"});
      ADD_FAILURE() << "two commands in one folder";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(),
                  AllOf(HasSubstr("output folder in use at --out new/out"), HasSubstr("locked by process ")));
    }
  }
  EXPECT_FALSE(fs::exists("new/out"));
}

}  // namespace
}  // namespace swingbank
