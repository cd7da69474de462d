// PSCAD output: .inf and .out files as EMTDC writes them, and the faults of incomplete or inconsistent ones.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/record/example.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kRows = 60;

class RecordPscadTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  /// Writes case.inf: eleven other channels around V [kV], f [Hz], P [MW] and Q [Mvar], of which V is in the
  /// first file, and f, P and Q are in the second.
  void write_inf(const char* names = "V f P Q", const char* units = "kV Hz MW MVAR") const {
    std::string text;
    std::istringstream name(names), unit(units);
    const auto add = [&](int number, const std::string& desc, const std::string& of) {
      text += fmt::format("PGB({}) Output Desc=\"{}\" Group=\"Main\" Max=2.0 Min=-2.0 Units=\"{}\"\n", number,
                          desc, of);
    };
    std::string n, u;
    for (int k = 1; k <= 13; ++k) {
      const bool read = k == 4 || k > 10;
      if (read) name >> n, unit >> u;
      add(k, read ? n : fmt::format("control {}", k), read ? u : "");
    }
    write("case.inf", text);
  }
  /// Writes a part: `values` per channel, as EMTDC formats them.
  void write_part(const char* name, const std::vector<double>& values, int rows = kRows,
                  const std::string& end = "\n", double shift = 0) const {
    std::string text = "Test Case                                              \n";
    for (int k = 0; k < rows; ++k) {
      text += fmt::format(" {:22.14E}", k / 60.0 + shift);
      for (const double v : values) text += fmt::format(" {:22.14E}", v);
      text += k + 1 < rows ? "\n" : end;
    }
    write(name, text);
  }
  void write_case() const {
    write_inf();
    write_part("case_01.out", {0, 0, 0, 140.76, 0, 0, 0, 0, 0, 0});
    write_part("case_02.out", {60, 80, 20});
  }
  [[nodiscard]] std::vector<std::string> complaints(const char* name = "case.inf",
                                                    const ReadOptions& options = {}) const {
    return test::messages([&] { read_record(folder_ / name, kTestBase, options); });
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / fmt::format("pscad_{}", ::getpid());
};

TEST_F(RecordPscadTest, AnyFileNamesTheRecord) {
  write_case();
  std::string hash;
  for (const char* name : {"case.inf", "case_01.out", "case_02.out"}) {
    const Record r = read_record(folder_ / name, kTestBase);
    expect_values(r);
    EXPECT_EQ(r.samples(), kRows) << name;
    EXPECT_EQ(r.format, "PSCAD");
    EXPECT_NEAR(r.rate(), 60, 1e-3);
    EXPECT_EQ(r.sha256, hash.empty() ? r.sha256 : hash);
    hash = r.sha256;
  }
  const Source source(folder_ / "case_02.out");
  EXPECT_THAT(source.files.front().all_files(),
              ElementsAre(folder_ / "case.inf", folder_ / "case_01.out", folder_ / "case_02.out"));
}

TEST_F(RecordPscadTest, ColumnsAreMappedByName) {
  write_case();
  write_inf("V_poi f_poi P_poi Q_poi", "kV Hz MW MVAR");
  EXPECT_THAT(complaints(),
              ::testing::Contains(AllOf(HasSubstr("no column V_pu"), HasSubstr("'V_poi' [kV]"))));
  expect_values(read_record(folder_ / "case.inf", kTestBase,
                            {.columns = {{"V", "V_poi"}, {"f", "f_poi"}, {"P", "P_poi"}, {"Q", "Q_poi"}}}));
}

TEST_F(RecordPscadTest, GroupSelectsAmongEqualNames) {
  std::string text;
  int number = 0;
  for (const char* group : {"G1", "G2"})
    for (const char* name : {"V pu", "theta rad", "P MW", "Q Mvar"}) {
      const std::string word = name;
      text += fmt::format("PGB({}) Output Desc=\"{}\" Group=\"{}\" Max=2.0 Min=-2.0 Units=\"{}\"\n", ++number,
                          word.substr(0, word.find(' ')), group, word.substr(word.find(' ') + 1));
    }
  write("case.inf", text);
  write_part("case_01.out", {1, 0, 10, 5, 1.02, 0, 80, 20});
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("several terminals"), HasSubstr("G1, G2"))));
  expect_values(read_record((folder_ / "case.inf").string() + "#G2", kTestBase));
}

TEST_F(RecordPscadTest, FortranNumbers) {
  write_case();
  std::string text = "\n";
  for (int k = 0; k < kRows; ++k)
    text += fmt::format("{:.8f} 0.60D+02 80.0 {}\n", k / 60.0, k == 9 ? "0.2000000000E-100" : "+2.0E+1");
  write("case_02.out", text);
  const Record r = read_record(folder_ / "case.inf", kTestBase);
  EXPECT_NEAR(r.Q[5], 0.1, 1e-9);
  EXPECT_NEAR(r.Q[9], 0, 1e-9);
}

TEST_F(RecordPscadTest, RefusesAnOverflow) {
  write_case();
  std::string text = "\n";
  for (int k = 0; k < kRows; ++k)
    text += fmt::format("{:.8f} 60.0 80.0 {}\n", k / 60.0, k == 9 ? "0.2000000000E+400" : "20.0");
  write("case_02.out", text);
  EXPECT_THAT(complaints(),
              ElementsAre(AllOf(HasSubstr("Q = '0.2000000000E+400'"), HasSubstr("case_02.out:11"))));
}

TEST_F(RecordPscadTest, RefusesMissingPart) {
  write_case();
  std::filesystem::remove(folder_ / "case_02.out");
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("no file at"), HasSubstr("case_02.out"))));
  EXPECT_THAT(complaints("case_01.out"), ElementsAre(HasSubstr("case_02.out")));
  std::filesystem::remove(folder_ / "case.inf");
  EXPECT_THAT(complaints("case_01.out"), ElementsAre(AllOf(HasSubstr("PSCAD"), HasSubstr("NAME.inf"))));
}

TEST_F(RecordPscadTest, RefusesPartsOfDifferentRuns) {
  write_case();
  write_part("case_02.out", {60, 80, 20}, kRows - 3);
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("57 rows"), HasSubstr("case_02.out:58"),
                                              HasSubstr("case_01.out has 60"))));
  write_part("case_02.out", {60, 80, 20}, kRows, "\n", 0.001);
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("t = 0.001 s"), HasSubstr("case_02.out:2"))));
}

TEST_F(RecordPscadTest, ReportsAllFaultsWithTheirLines) {
  write_case();
  std::string text = "Test Case\n";
  for (int k = 0; k < kRows; ++k)
    text += k + 1 == kRows ? fmt::format("{:.6f} 60.0 8", k / 60.0)
            : k == 20      ? fmt::format("{:.6f} 60.0 80.0\n", k / 60.0)
                           : fmt::format("{:.6f} 60.0 {} {}\n", k / 60.0, k > 29 && k < 33 ? "NaN" : "80.0",
                                    k == 40 ? "****" : "20.0");
  write("case_02.out", text);
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("truncated"), HasSubstr("case_02.out:61")),
                                        AllOf(HasSubstr("3 columns in 1 row"), HasSubstr("case_02.out:22")),
                                        AllOf(HasSubstr("P = 'NaN'"), HasSubstr("case_02.out:32-34")),
                                        AllOf(HasSubstr("Q = '****'"), HasSubstr("case_02.out:42"))));
}

TEST_F(RecordPscadTest, RefusesLineThatEndsWithinANumber) {
  write_case();
  write_part("case_02.out", {60, 80, 20}, kRows, "");
  expect_values(read_record(folder_ / "case.inf", kTestBase));  // complete, without its end of line
  std::filesystem::resize_file(folder_ / "case_02.out",
                               std::filesystem::file_size(folder_ / "case_02.out") - 6);
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("truncated"), HasSubstr("case_02.out:61"))));
}

TEST_F(RecordPscadTest, RefusesFaultyList) {
  write_case();
  write("case.inf",
        "PGB(1) Output Desc=\"V\" Units=\"pu\"\nPGB(1) Output Desc=\"P\"\nPGB(0) Output Desc=\"Q\"\n");
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("PGB(1) twice"), HasSubstr("case.inf:2")),
                                        AllOf(HasSubstr("without number"), HasSubstr("case.inf:3"))));
  write("case.inf", "nothing\n");
  EXPECT_THAT(complaints(), ElementsAre(HasSubstr("no channels")));
}

TEST_F(RecordPscadTest, RefusesWaveforms) {
  write_case();
  write_inf("Va Vb Vc Q", "kV kV kV MVAR");
  EXPECT_THAT(complaints(), ::testing::Contains(AllOf(HasSubstr("three-phase channels Va, Vb, Vc"),
                                                      HasSubstr("RMS Voltmeter"))));
}

TEST_F(RecordPscadTest, FaultsOutsideTheTimeRangeDoNotMatter) {
  write_case();
  std::string text = "Test Case\n";
  for (int k = 0; k < kRows; ++k)
    text += fmt::format("{:.8f} 60.0 80.0 {}\n", k / 60.0, k > 45 ? "NaN" : "20.0");
  write("case_02.out", text);
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("case_02.out:48-61"), HasSubstr("--until"))));
  EXPECT_EQ(read_record(folder_ / "case.inf", kTestBase, {.until = 0.755}).samples(), 46);
}

}  // namespace
}  // namespace swingbank::validate::record
