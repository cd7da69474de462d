// MATLAB files, written here by libmatio in the usual export formats, read as records.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/validate/playin/support.hpp"
#include "validate/record/record.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kSamples = 90;
const RecordBase kMatBase{100, 60, 138};

/// Sample k of t [s], V [kV], f [Hz], P [MW], Q [Mvar].
double sample(int column, int k) {
  const double values[] = {k / 30.0, 138 + 0.1 * std::sin(k), 60 + 0.001 * k, 80 + 0.01 * k, 20 - 0.01 * k};
  return values[column];
}
std::vector<double> column_of(int c, int samples = kSamples) {
  std::vector<double> values;
  for (int k = 0; k < samples; ++k) values.push_back(sample(c, k));
  return values;
}
matvar_t* vector_of(const char* name, std::vector<double> values) {
  std::size_t dims[] = {values.size(), 1};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
}
matvar_t* text_variable(const char* name, std::string text) {
  std::size_t dims[] = {1, text.size()};
  return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, dims, text.data(), 0);
}
matvar_t* cells(const char* name, const std::vector<std::string>& texts) {
  std::size_t dims[] = {1, texts.size()};
  matvar_t* list = Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, dims, nullptr, 0);
  for (std::size_t k = 0; k < texts.size(); ++k)
    Mat_VarSetCell(list, static_cast<int>(k), text_variable(nullptr, texts[k]));
  return list;
}
/// Returns a struct with the given fields.
matvar_t* structure(const char* name, std::vector<const char*> names, const std::vector<matvar_t*>& fields) {
  std::size_t dims[] = {1, 1};
  matvar_t* s = Mat_VarCreateStruct(name, 2, dims, names.data(), static_cast<unsigned>(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k) Mat_VarSetStructFieldByName(s, names[k], 0, fields[k]);
  return s;
}

class RecordMatTest : public ::testing::TestWithParam<mat_ft> {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::vector<matvar_t*>& variables) const {
    std::filesystem::remove(file_);
    mat_t* mat = Mat_CreateVer(file_.c_str(), nullptr, GetParam());
    ASSERT_NE(mat, nullptr);
    for (matvar_t* v : variables) {
      EXPECT_EQ(Mat_VarWrite(mat, v, MAT_COMPRESSION_ZLIB), 0) << v->name;
      Mat_VarFree(v);
    }
    Mat_Close(mat);
  }
  [[nodiscard]] std::vector<std::string> complaints(const ReadOptions& options = {}) const {
    return test::messages([&] { read_record(file_, kMatBase, options); });
  }
  void expect_record(const ReadOptions& options = {}) const {
    const Record r = read_record(file_, kMatBase, options);
    ASSERT_EQ(r.samples(), kSamples);
    EXPECT_EQ(r.format, GetParam() == MAT_FT_MAT73 ? "MATLAB 7.3" : "MATLAB");
    EXPECT_EQ(r.angle, AngleSource::integrated);
    for (const int k : {0, 1, kSamples - 1}) {
      const auto i = static_cast<std::size_t>(k);
      EXPECT_NEAR(r.t[i], sample(0, k), 1e-9);
      EXPECT_NEAR(r.V[i], sample(1, k) / 138, 1e-12);
      EXPECT_NEAR(r.f[i], sample(2, k) / 60 - 1, 1e-12);
      EXPECT_NEAR(r.P[i], sample(3, k) / 100, 1e-12);
      EXPECT_NEAR(r.Q[i], sample(4, k) / 100, 1e-12);
    }
  }
  static std::vector<matvar_t*> vectors() {
    const char* names[] = {"t_s", "V_kV", "f_Hz", "P_MW", "Q_Mvar"};
    std::vector<matvar_t*> all;
    for (int c = 0; c < 5; ++c) all.push_back(vector_of(names[c], column_of(c)));
    return all;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / fmt::format("swingbank-mat-{}", getpid());
  const std::filesystem::path file_ = folder_ / "event.mat";
};

TEST_P(RecordMatTest, VectorsAreColumns) {
  auto variables = vectors();
  variables.push_back(text_variable("comment", "line trip"));
  write(variables);
  expect_record();
}

TEST_P(RecordMatTest, NamesWithoutUnitsAreMapped) {
  write({vector_of("clock", column_of(0)), vector_of("Ubus", column_of(1)), vector_of("fbus", column_of(2)),
         vector_of("Pgen", column_of(3)), vector_of("Qgen", column_of(4)), vector_of("other", {1, 2, 3})});
  expect_record({.columns = {{"t", "clock [s]"},
                             {"V", "Ubus [kV]"},
                             {"f", "fbus [Hz]"},
                             {"P", "Pgen [MW]"},
                             {"Q", "Qgen [Mvar]"}}});
  // HDF5 sorts the variables by name.
  const bool sorted = GetParam() == MAT_FT_MAT73;
  const auto number = [&](int written, int by_name) {
    return fmt::format("#{}", sorted ? by_name : written);
  };
  expect_record({.columns = {{"t", number(1, 4)},
                             {"V", number(2, 3) + " [kV]"},
                             {"f", number(3, 5) + " [Hz]"},
                             {"P", number(4, 1) + " [MW]"},
                             {"Q", number(5, 2) + " [Mvar]"}}});
  EXPECT_THAT(complaints({.columns = {{"t", "watch [s]"}}}),
              ElementsAre(AllOf(HasSubstr("no time vector 'watch [s]'"), HasSubstr("clock (90x1)"))));
}

TEST_P(RecordMatTest, RefusesAChannelThatIsNotAsLongAsTheTime) {
  auto power = column_of(3);
  power.pop_back();
  auto variables = vectors();
  Mat_VarFree(std::exchange(variables[3], vector_of("P_MW", power)));
  write(variables);
  EXPECT_THAT(complaints(), ElementsAre(HasSubstr("the time has 90 samples, P_MW has 89")));
}

TEST_P(RecordMatTest, NumbersCountVectorsOfOtherLengths) {
  auto variables = vectors();
  variables.insert(variables.begin(), vector_of("A", {1, 2, 3}));
  write(variables);
  const bool sorted = GetParam() == MAT_FT_MAT73;  // A, P_MW, Q_Mvar, V_kV, f_Hz, t_s
  expect_record({.columns = {{"t", sorted ? "#6" : "#2"}, {"P", sorted ? "#2" : "#5"}}});
  EXPECT_THAT(complaints({.columns = {{"P", "#1 [MW]"}}}), ElementsAre(HasSubstr("A = ''")));
}

TEST_P(RecordMatTest, MatrixHasItsListOfNames) {
  std::vector<double> all;
  for (int c = 0; c < 5; ++c)
    for (const double v : column_of(c)) all.push_back(v);
  std::size_t dims[] = {kSamples, 5};
  write({Mat_VarCreate("data", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, all.data(), 0),
         cells("names", {"t [s]", "V [kV]", "f [Hz]", "P [MW]", "Q [Mvar]"})});
  expect_record();
}

TEST_P(RecordMatTest, StructOfVectorsIsATerminal) {
  write({structure(
      "G1", {"time", "V_kV", "f_Hz", "P_MW", "Q_Mvar"},
      {vector_of("time", column_of(0)), vector_of("V_kV", column_of(1)), vector_of("f_Hz", column_of(2)),
       vector_of("P_MW", column_of(3)), vector_of("Q_Mvar", column_of(4))})});
  expect_record();
}

TEST_P(RecordMatTest, SignalsWithTimesOfTheirOwnShareThem) {
  const char* names[] = {"t", "V_kV", "f_Hz", "P_MW", "Q_Mvar"};
  const auto series = [&](int c, double late) {
    auto time = column_of(0);
    for (double& t : time) t += late;
    return structure(names[c], {"Time", "Data"}, {vector_of("Time", time), vector_of("Data", column_of(c))});
  };
  write({series(1, 0), series(2, 0), series(3, 0), series(4, 0)});
  expect_record();
  write({series(1, 0), series(2, 0), series(3, 0.01), series(4, 0)});
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("different times"), HasSubstr("synchronize"))));
}

TEST_P(RecordMatTest, ListsVariablesOfTheFile) {
  write({vector_of("bus7", column_of(1)), text_variable("comment", "line trip")});
  EXPECT_THAT(complaints(), ElementsAre(AllOf(HasSubstr("no time vector"), HasSubstr("bus7 (90x1)"),
                                              HasSubstr("comment (1x9)"))));
}

TEST_P(RecordMatTest, RefusesTruncatedFile) {
  write(vectors());
  const auto whole = std::filesystem::file_size(file_);
  for (const double part : {0.02, 0.5, 0.97}) {
    std::filesystem::resize_file(file_, static_cast<std::uintmax_t>(part * static_cast<double>(whole)));
    EXPECT_THAT(complaints(), ElementsAre(HasSubstr("cannot read the MATLAB file"))) << part;
    write(vectors());
  }
  std::ofstream(file_) << "t_s,V_pu\n";
  EXPECT_THAT(complaints(), ElementsAre(HasSubstr("is not a MATLAB file")));
}

INSTANTIATE_TEST_SUITE_P(Versions, RecordMatTest, ::testing::Values(MAT_FT_MAT5, MAT_FT_MAT73),
                         [](const auto& which) { return which.param == MAT_FT_MAT5 ? "v5" : "v73"; });

}  // namespace
}  // namespace swingbank::validate::record
