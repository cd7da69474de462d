// Frames that are no measurements, words for missing values, thousands separators, and files that are no
// records.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/validate/playin/support.hpp"
#include "tests/validate/record/example.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kHeading = "t_s,V_pu,theta_rad,P_pu,Q_pu\n";
/// A frame of a slow swing.
std::string frame(int k, double t) {
  return fmt::format("{:.7f},{:.7f},0.1,{:.7f},0.1", t, 1.02 + 1e-3 * std::sin(k / 30.0),
                     0.4 + 1e-3 * std::cos(k / 20.0));
}
template <class F>
std::string frames(F line, int count = 300) {
  std::string all = kHeading;
  for (int k = 0; k < count; ++k) all += line(k);
  return all;
}
std::vector<std::string> frame_faults(const std::string& text, const char* name = "r.csv") {
  return test::messages([&] { parse_record(text, name, kTestBase); });
}

TEST(ZeroFrameTest, IsInterpolatedLikeALostFrame) {
  const Record r = parse_record(frames([](int k) {
                                  return k == 150 || k == 151 ? fmt::format("{:.7f},0,0,0,0\n", k / 30.0)
                                                              : frame(k, k / 30.0) + "\n";
                                }),
                                "r.csv", kTestBase);
  EXPECT_EQ(r.samples(), 300);
  EXPECT_NEAR(r.V[150], 1.02 + 1e-3 * std::sin(5.0), 1e-6);
  EXPECT_NEAR(r.P[151], 0.4 + 1e-3 * std::cos(151 / 20.0), 1e-6);
  EXPECT_EQ(std::ranges::count(r.lost, 1), 2);
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("2 samples are exactly zero"), HasSubstr("r.csv:152"))));
}
TEST(ZeroFrameTest, BoltedFaultStaysMeasured) {
  const Record r = parse_record(frames([](int k) {
                                  const double t = k / 60.0;
                                  if (k >= 120 && k < 126) return fmt::format("{:.7f},0,0,0,0\n", t);
                                  return fmt::format("{:.7f},{},0.1,{},0.1\n", t, k < 120 ? 1.02 : 0.9,
                                                     k < 120 ? 0.4 : 0.55);
                                }),
                                "r.csv", kTestBase);
  EXPECT_THAT(r.lost, IsEmpty());
  EXPECT_EQ(r.V[122], 0);
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("6 samples are exactly zero"),
                                      HasSubstr("a fault at the terminals"))));
}
TEST(ZeroFrameTest, LongGapsOfZerosAreRefused) {
  EXPECT_THAT(
      frame_faults(frames([](int k) {
        return k >= 150 && k < 160 ? fmt::format("{:.7f},0,0,0,0\n", k / 30.0) : frame(k, k / 30.0) + "\n";
      })),
      Contains(AllOf(HasSubstr("V_pu = 0"), HasSubstr("r.csv:152-161"), HasSubstr("not a measurement"))));
}
TEST(RepeatedBlockTest, OfOverlappingArchivesIsDropped) {
  const Record r = parse_record(frames([](int k) {
                                  std::string line = frame(k, k / 30.0) + "\n";
                                  if (k == 199)  // the next archive starts two thirds of a second earlier
                                    for (int again = 180; again < 200; ++again)
                                      line += frame(again, again / 30.0) + "\n";
                                  return line;
                                }),
                                "r.csv", kTestBase);
  EXPECT_EQ(r.samples(), 300);
  EXPECT_NEAR(r.t.back(), 299 / 30.0, 1e-6);
  EXPECT_NEAR(r.V[250], 1.02 + 1e-3 * std::sin(250 / 30.0), 1e-6);
  EXPECT_THAT(r.lost, IsEmpty());
  EXPECT_THAT(r.notes, ElementsAre(AllOf(HasSubstr("20 rows repeat"), HasSubstr("r.csv:202"))));
}
TEST(RasterTest, DropsRowsOffTheRaster) {
  for (const int odd : {0, 77, 299}) {
    const Record r =
        parse_record(frames([&](int k) {
                       return frame(k, k / 60.0 + (k == odd ? (k == 0 ? -0.0041616 : 0.0041616) : 0)) + "\n";
                     }),
                     "r.csv", kTestBase);
    EXPECT_EQ(r.samples(), odd == 77 ? 300 : 299);
    EXPECT_NEAR(r.rate(), 60, 1e-3);
    EXPECT_EQ(std::ranges::count(r.lost, 1), odd == 77 ? 1 : 0);
    EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("1 row does not fit the uniform sampling"),
                                        HasSubstr(fmt::format("r.csv:{}", odd + 2)))));
  }
}
TEST(RasterTest, AcceptsRepeatedLastFrame) {
  const std::string text = frames([](int k) { return frame(k, k / 30.0) + "\n"; });
  const Record r = parse_record(text + frame(299, 299 / 30.0) + "\n", "r.csv", kTestBase);
  EXPECT_EQ(r.samples(), 300);
}

TEST(MissingWordTest, MarksLostFrames) {
  for (const char* word :
       {"Non un numero", "NeuN", "Não é um número", "Non Numérique", "не число", "n. def.", "No Data", "Bad",
        "I/O Timeout", "#N/A", "-1.#IND", "-nan(ind)", "Keine Daten", "---", "Perdu"}) {
    const Record r = parse_record(frames([&](int k) {
                                    return k == 150 ? fmt::format("5.0,{0},{0},{0},{0}\n", word)
                                                    : frame(k, k / 30.0) + "\n";
                                  }),
                                  "r.csv", kTestBase);
    EXPECT_EQ(std::ranges::count(r.lost, 1), 1) << word;
    EXPECT_NEAR(r.V[150], 1.02 + 1e-3 * std::sin(5.0), 1e-6) << word;
  }
  const auto text = frames(
      [](int k) { return k == 150 ? std::string("5.0,Perdu,0.1,0.4,0.1\n") : frame(k, k / 30.0) + "\n"; });
  EXPECT_THAT(parse_record(text, "r.csv", kTestBase).notes,
              Contains(AllOf(HasSubstr("'Perdu'"), HasSubstr("r.csv:152"), HasSubstr("treated as missing"))));
}
TEST(HeadingTest, DecidesTheSeparator) {
  const std::string table = frames([](int k) { return frame(k, k / 30.0) + "\n"; });
  for (const char* before : {"PMU report;;;\nStation: North\n\n",
                             "Average;345,99\nMaximum;350,18\nMinimum;340,2\n", "Point\tUnit 4\n"})
    EXPECT_EQ(parse_record(before + table, "r.csv", kTestBase).samples(), 300) << before;
  std::string semicolons = "Export of 12:00, 1 May, by A, B\nt_s;V_pu;theta_rad;P_pu;Q_pu\n";
  for (int k = 0; k < 90; ++k) semicolons += fmt::format("{:.4f};1,02;0,1;0,4;0,1\n", k / 30.0);
  std::ranges::replace(semicolons, '.', ',');
  expect_values(parse_record(semicolons, "r.csv", kTestBase));
}
TEST(NumberTest, ThousandsSeparatorsInQuotes) {
  const auto read = [](const char* heading, const char* row) {
    std::string all = heading;
    for (int k = 0; k < 90; ++k) all += fmt::format(fmt::runtime(row), k / 30.0);
    return parse_record(all, "r.csv", kTestBase);
  };
  expect_values(
      read("t_s,V_V,theta_rad,P_kW,Q_kvar\n", "{:.7f},\"140,760.0\",0.1,\"80,000.00\",\"20,000.0\"\n"));
  expect_values(read("t_s,V_V,theta_rad,P_GW,Q_Gvar\n", "{:.7f},140760,0.1,0.08,0.02\n"));
  expect_values(read("t_s,V_V,theta_rad,P_W,Q_var\n", "{:.7f},140760,0.1,\"80,000,000\",\"20,000,000\"\n"));
  std::string all = "t_s;V_V;theta_rad;P_kW;Q_kvar\n";
  for (int k = 0; k < 90; ++k)
    all += fmt::format(
        "{},{:07};140.760,0;0,1;80'000,0;20\xC2\xA0"
        "000,0\n",
        k / 30, k % 30 * 10000000 / 30);
  expect_values(parse_record(all, "r.csv", kTestBase));
  EXPECT_THAT(test::messages(
                  [&] { read("t_s,V_V,theta_rad,P_kW,Q_kvar\n", "{:.7f},\"140,760\",0.1,80000,20000\n"); }),
              ElementsAre(AllOf(HasSubstr("'140,760'"), HasSubstr("thousands"))));
}
TEST(UnitTest, SpellingsOfPmusAndHistorians) {
  std::string all =
      "Time,Voltage Magnitude,Voltage Angle,Active Power,Reactive Power,Frequency\n"
      "(UTC),(kV L-L),(degrees),(MWatts),(MVAr),(Hertz)\n";
  for (int k = 0; k < 90; ++k) all += fmt::format("2026-03-01 14:05:{:06.3f},140.76,10,80,20,60\n", k / 30.0);
  expect_values(parse_record(all, "r.csv", kTestBase));
  all = "t_s,\"V (pu, pos. seq.)\",theta (rad),P (MW),Q (Mvar),f_mHz\n";
  for (int k = 0; k < 90; ++k) all += fmt::format("{:.7f},1.02,0.1,80,20,12\n", k / 30.0);
  const Record r = parse_record(all, "r.csv", kTestBase);
  expect_values(r);
  EXPECT_NEAR(r.f[5], 0.012 / 60, 1e-12) << "a deviation from nominal";
  EXPECT_THAT(frame_faults("t_s,V (kV peak),theta_rad,P_pu,Q_pu\n0,1,1,1,1\n"),
              ElementsAre(HasSubstr("'V (kV peak)'")));
}
TEST(OtherFileTest, NamesTheFileType) {
  EXPECT_THAT(frame_faults("SignalID,Timestamp,Value\nPPA:1,2026-03-01 14:05:20.000,339.5\n"
                           "PPA:2,2026-03-01 14:05:20.000,-0.18\n"),
              ElementsAre(AllOf(HasSubstr("(long format)"), HasSubstr("'SignalID'"),
                                HasSubstr("a column for each quantity"))));
  EXPECT_THAT(frame_faults("PK\x03\x04zipped record", "ev.zip"),
              ElementsAre(AllOf(HasSubstr("a zip archive"), HasSubstr("unpack"))));
  EXPECT_THAT(frame_faults("PK\x03\x04..[Content_Types].xml", "r.csv"),
              ElementsAre(HasSubstr("spreadsheet")));
  EXPECT_THAT(frame_faults("# made by hand\n[plant]\nname = \"a\"\n", "plant.toml"),
              ElementsAre(AllOf(HasSubstr("a plant file"), HasSubstr("--model"), HasSubstr("--records"))));
}
TEST(OtherFileTest, NamesCodes) {
  const Record r =
      parse_record(frames([](int k) {
                     return k == 150 ? std::string("5.0,1.02,0.1,1e308,0.1\n") : frame(k, k / 30.0) + "\n";
                   }),
                   "r.csv", kTestBase);
  EXPECT_THAT(r.notes, Contains(AllOf(HasSubstr("P_pu has no value in 1 of 300 samples"),
                                      HasSubstr("a code such as"))));
}

}  // namespace
}  // namespace swingbank::validate::record
