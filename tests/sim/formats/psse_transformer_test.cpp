// Every coding of a transformer must give the same branch.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/sim/formats/raw_case.hpp"

namespace swingbank::sim::formats {
namespace {

using ::testing::HasSubstr;

RawCase with_transformer(const std::string& transformer) {
  RawCase c;  // buses of 20 kV and 110 kV
  c.buses =
      "101,'LOW', 20.0,3,1,1,1,1.05,0.0\n102,'HIGH',110.0,2,1,1,1,1.02,-0.9\n"
      "103,'SOUTH',110.0,1,1,1,1,0.99,-8.7\n";
  c.transformers = transformer;
  return c;
}

// 200 MVA, R 0.4 %, X 12 %, ratio 1.05 : 0.98, 30 degrees; no-load loss 0.1 MW and 0.5 % exciting current.
struct TransformerCoding {
  const char *name, *text;
};
class PsseTransformer : public ::testing::TestWithParam<TransformerCoding> {};
TEST_P(PsseTransformer, GivesTheSameBranch) {
  const network::Network n = with_transformer(GetParam().text).read();
  const network::Branch& b = n.branches.back();
  const double t2 = 0.98, r = 0.004 * 100 / 200 * t2 * t2, x = 0.12 * 100 / 200 * t2 * t2;
  const double g = 0.1 / 100, y = 0.005 * 200 / 100;
  constexpr double tolerance = 1e-14;  // rounding of values of order 1
  EXPECT_TRUE(b.transformer);
  EXPECT_NEAR(b.r, r, tolerance);
  EXPECT_NEAR(b.x, x, tolerance);
  EXPECT_NEAR(b.tap, 1.05 / 0.98, tolerance);
  EXPECT_NEAR(b.shift, M_PI / 6, tolerance);
  EXPECT_NEAR(b.shunt_from.real(), g, tolerance);
  EXPECT_NEAR(b.shunt_from.imag(), -std::sqrt(y * y - g * g), tolerance);
  EXPECT_EQ(b.circuit, "T1");
}
// Z = 0.12006664815842909 pu has R = 0.004 (0.8 MW at 200 MVA) and X = 0.12; Y = 0.01 has
// B = -0.0099498743710662.
INSTANTIATE_TEST_SUITE_P(
    Codes, PsseTransformer,
    ::testing::Values(
        TransformerCoding{"SystemBase",
                          "101,102,0,'T1',1,1,1,0.001,-0.00994987437106620,2,'A, "
                          "B',1,1,1\n0.002,0.06,200\n1.05,0,30.0\n0.98,0\n"},
        TransformerCoding{
            "OwnBase", "101,102,0,'T1',1,2,2,1e5,0.005,2,'',1,1,1\n0.004,0.12,200\n1.05,20,30.0\n0.98,110\n"},
        TransformerCoding{
            "KiloVolt", "101,102,0,'T1',2,2,2,1D5,0.005,2,'',1,1,1\n0.004,0.12,200\n21.0,0,30.0\n107.8,0\n"},
        TransformerCoding{
            "Nominal",
            "101,102,0,'T1',3,2,1,0.001,-0.00994987437106620,2,'',1,1,1\n0.004,0.12,200\n1.0,21,30.0\n"
            "1.078,100\n"},
        TransformerCoding{
            "LoadLoss",
            "101,102,0,'T1',1,3,2,1e5,0.005,2,'',1,1,1\n8e5,0.12006664815842909,200\n1.05,0,30.0\n0.98,0\n"}),
    [](const auto& test) { return test.param.name; });

TEST(PsseTransformerDefaults, CodesTapsAndBasesMayBeOmitted) {
  const network::Branch b = with_transformer("101,102\n,0.06\n,\n1.0\n").read().branches.back();
  EXPECT_EQ(b.circuit, "1");
  EXPECT_EQ(b.tap, 1.0);
  EXPECT_EQ(b.x, 0.06);
  EXPECT_EQ(b.shift, 0.0);
}

TEST(PsseTransformerFaults, AreReportedWithLine) {
  const std::string text =
      "101,102,0,'1',4,5,6,0,0,2,'',1,1,1\n0,0,200\n-1.0,0,0\n1.0,0\n"
      "101,103,0,'1',1,2,1,0,0,2,'',1,1,1\n0,0.1,0\n1.0,0,0,0,0,0,0,0,0,0,0,0,0,7\n1.0,0\n"
      "102,103,0,'1',1,3,2,9e9,0.01,2,'',1,1,1\n9e9,0.1,100\n1.0,0,0\n1.0,0\n";
  const RawCase c = with_transformer(text);
  const std::string all = sentences_of([&] { c.read(); });
  const int first = line_of(c.text(), "101,102,0,'1',4");
  const auto at = [&](int offset) { return "case.raw:" + std::to_string(first + offset); };
  for (const auto& [what, offset] : {std::pair{"CW = 4", 0},
                                     {"CZ = 5", 0},
                                     {"CM = 6", 0},
                                     {"WINDV1 = -1", 2},
                                     {"SBASE1-2 = 0 MVA", 5},
                                     {"TAB1 = 7", 6},
                                     {"MAG2 = 0.01 pu", 8},
                                     {"X1-2 = 0.1 pu", 9}})
    EXPECT_THAT(all, HasSubstr(std::string(what) + " at ")) << offset;
  for (const int offset : {0, 2, 5, 6, 8, 9}) EXPECT_THAT(all, HasSubstr(at(offset)));
}

TEST(PsseTransformerFaults, IncompleteRecordDoesNotConsumeTheNextSection) {
  const RawCase c = with_transformer("101,102,0,'1',1,1,1\n0,0.1,100\n");
  const auto problems = problems_of([&] { c.read(); });
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].what, HasSubstr("2 lines"));
}

}  // namespace
}  // namespace swingbank::sim::formats
