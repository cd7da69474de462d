// A run as `swingbank simulate --out run.h5` writes it (docs/reference/formats.md), read as a record.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "mpi/store/hdf5_file.hpp"
#include "tests/validate/playin/support.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Positions in the file written by `write`: the signature, and descriptions whose damage crashes HDF5 1.10
/// (or, in one case, makes it loop endlessly).
constexpr std::size_t kDamaged[] = {0, 6505, 6530, 6555, 6580, 6600, 10695, 10725};

class RecordHdf5Test : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Two plants with delta, P, Q, V, theta; value = plant + channel / 10 + time / 100.
  /// The given number of samples of P of the second plant, from the twentieth on, are NaN.
  void write(const std::string& format, hsize_t channels = 5, std::size_t missing = 0) {
    const std::lock_guard guard(mpi::store::h5::lock());
    mpi::store::h5::File h = mpi::store::h5::File::create(file_);
    std::vector<double> time, values;
    for (int k = 0; k < 50; ++k) time.push_back(k / 60.0);
    for (int plant = 0; plant < 2; ++plant)
      for (int c = 0; c < static_cast<int>(channels); ++c)
        for (const double t : time) values.push_back(plant + c / 10.0 + t / 100);
    for (std::size_t k = 0; k < missing; ++k) values[(channels + 1) * time.size() + 20 + k] = std::nan("");
    h.create<double>("/time", {50});
    h.write("/time", 0, 50, time.data());
    h.create<double>("/records", {2, channels, 50});
    h.write("/records", 0, 2, values.data());
    h.attribute("format", format);
    h.attribute("plant_names", std::vector<std::string>{"GENROU 1", "GENROU 7"});
    h.attribute("plant_base_mva", std::vector<double>{100, 300});
    h.attribute("channel_names", std::vector<std::string>{"delta", "P", "Q", "V", "theta"});
    h.attribute("channel_units", std::vector<std::string>{"rad", "pu", "pu", "pu", "rad"});
    h.close();
  }
  std::vector<std::string> faults(const std::string& terminal) {
    return test::messages([&] { read_record(file_.string() + terminal, {}); });
  }
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / fmt::format("run-{}", ::getpid());
  std::filesystem::path file_ = folder_ / "run.h5";
};

TEST_F(RecordHdf5Test, OnePlantOnTheRecordsBase) {
  write("swingbank-run-1");
  const Record r = read_record(file_.string() + "#GENROU 7", {150, 60, 0});
  ASSERT_EQ(r.samples(), 50);
  const double t = 7 / 60.0;
  EXPECT_DOUBLE_EQ(r.t[7], t);
  EXPECT_DOUBLE_EQ(r.P[7], (1.1 + t / 100) * 2);  // 300 MVA to 150 MVA
  EXPECT_DOUBLE_EQ(r.Q[7], (1.2 + t / 100) * 2);
  EXPECT_DOUBLE_EQ(r.V[7], 1.3 + t / 100);
  EXPECT_DOUBLE_EQ(r.theta[7], 1.4 + t / 100);
  EXPECT_EQ(r.terminal, "GENROU 7");
  EXPECT_EQ(r.name, "run.h5#GENROU 7");
  EXPECT_THAT(r.ignored, ElementsAre("delta"));
}
TEST_F(RecordHdf5Test, MissingSamplesAreBridged) {
  write("swingbank-run-1", 5, 1);
  const Record r = read_record(file_.string() + "#GENROU 7", {150, 60, 0});
  ASSERT_EQ(r.samples(), 50);
  EXPECT_EQ(std::ranges::count(r.lost, 1), 1);
  EXPECT_TRUE(std::isfinite(r.P[20]));
}
TEST_F(RecordHdf5Test, SeveralPlantsOrNoSuchPlant) {
  write("swingbank-run-1");
  EXPECT_THAT(faults(""), ElementsAre(AllOf(HasSubstr("several plants"), HasSubstr("GENROU 1, GENROU 7"))));
  EXPECT_THAT(faults("#GENROU 2"), ElementsAre(HasSubstr("no plant 'GENROU 2'")));
}
TEST_F(RecordHdf5Test, RefusesFilesWithoutARun) {
  write("swingbank-run-2");
  EXPECT_THAT(faults("#GENROU 7"), ElementsAre(HasSubstr("not a run of swingbank simulate")));
  write("swingbank-run-1", 4);
  EXPECT_THAT(faults("#GENROU 7"), ElementsAre(HasSubstr("inconsistent sizes")));
  EXPECT_THAT(faults("-missing.h5"), ElementsAre(HasSubstr("run.h5-missing.h5")));
}

// The file claims 44 TB, which neither the file nor any memory has.
TEST_F(RecordHdf5Test, RefusesMoreSamplesThanTheFileContains) {
  write("swingbank-run-1");
  std::string bytes = read_bytes(file_);
  const auto text = [](std::uint64_t samples) {
    const std::uint64_t shape[] = {2, 5, samples};
    return std::string(reinterpret_cast<const char*>(shape), sizeof shape);
  };
  const std::size_t at = bytes.find(text(50));
  ASSERT_NE(at, bytes.npos);
  bytes.replace(at, text(50).size(), text(std::uint64_t{1} << 39));
  std::ofstream(file_, std::ios::binary) << bytes;
  EXPECT_THAT(faults("#GENROU 7"),
              ElementsAre(AllOf(HasSubstr("an array too large to read at"), HasSubstr("run.h5:/records"),
                                HasSubstr("5497558138880"))));
}

// HDF5 crashes on some of these and loops endlessly on others.
TEST_F(RecordHdf5Test, RefusesDamagedBytes) {
  write("swingbank-run-1");
  const std::string whole = read_bytes(file_);
  ::setenv("SWINGBANK_READER_SECONDS", "1", 1);
  int reported = 0, crashed = 0;
  for (const std::size_t at : kDamaged) {
    ASSERT_LT(at, whole.size());
    std::string bytes = whole;
    bytes[at] = static_cast<char>(~bytes[at]);
    std::ofstream(file_, std::ios::binary) << bytes;
    for (const std::string& sentence : faults("#GENROU 7")) {
      ++reported;
      // The address sanitizer ends a reader by an exit code before the signal does.
      for (const char* end : {"a signal ended the reading process", "the reading process ended with code"})
        crashed += sentence.find(end) != sentence.npos ? 1 : 0;
      EXPECT_THAT(sentence, AllOf(HasSubstr(" at "), HasSubstr("run.h5"), HasSubstr("): "))) << at;
    }
  }
  ::unsetenv("SWINGBANK_READER_SECONDS");
  EXPECT_GE(reported, 6);
  EXPECT_GE(crashed, 3);
}
class RecordHdf5Nightly : public RecordHdf5Test {};
TEST_F(RecordHdf5Nightly, EveryFlippedByteOfTheDescriptions) {
  write("swingbank-run-1");
  const std::string whole = read_bytes(file_);
  ::setenv("SWINGBANK_READER_SECONDS", "2", 1);
  int tried = 0, reported = 0, crashed = 0;
  for (std::size_t at = 0; at < whole.size(); at += 5, ++tried) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(~bytes[at]);
    std::ofstream(file_, std::ios::binary) << bytes;
    std::vector<std::string> sentences;
    ASSERT_NO_THROW(sentences = test::messages([&] { read_record(file_.string() + "#GENROU 7", {}); })) << at;
    reported += sentences.empty() ? 0 : 1;
    crashed += !sentences.empty() && sentences[0].find("ended by a signal") != std::string::npos ? 1 : 0;
  }
  ::unsetenv("SWINGBANK_READER_SECONDS");
  fmt::print(
      "{} bytes flipped, {} told, {} of them by the reader's end; the others change a sample or nothing\n",
      tried, reported, crashed);
  EXPECT_GT(reported, 50);
}

}  // namespace
}  // namespace swingbank::validate::record
