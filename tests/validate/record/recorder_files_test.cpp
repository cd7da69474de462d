// Original COMTRADE files of recorders and relays.
#include <gmock/gmock.h>

#include "tests/sim/reference/psse_folder.hpp"
#include "validate/record/formats.hpp"

namespace swingbank::validate::record {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

/// Sources: README.md beside the files (psse_folder.hpp). The files name revisions that
/// the standard does not have, skip channel numbers, and contain text in Windows-1251.
TEST(RecorderFiles, AreRead) {
  const auto at = sim::test::record_folder("comtrade_files");
  const auto read = [&](const char* cfg, const char* dat) {
    const std::string c = read_bytes(at / cfg), d = read_bytes(at / dat);
    return parse_comtrade(c, d, cfg, dat);
  };
  Comtrade first = read("1.cfg", "1.dat");  // its rates follow the grid's frequency
  ASSERT_GT(first.stretches.size(), 20);
  Problems problems;
  make_even(first, 400, problems);
  EXPECT_TRUE(problems.empty());
  ASSERT_EQ(first.stretches.size(), 1);
  EXPECT_NEAR(first.stretches[0].rate, 2401, 3);
  EXPECT_THAT(first.notes, Contains(HasSubstr("resampled uniformly")));
  const Comtrade second = read("2.cfg", "2.dat"), fourth = read("4.CFG", "4.DAT");
  EXPECT_EQ(second.channels.size(), 55);
  EXPECT_THAT(second.notes,
              AllOf(Contains(HasSubstr("Windows-1251")), Contains(HasSubstr("skip from 11 to 13"))));
  EXPECT_EQ(second.channels[0].component, "1СШ-110_ТН_110кВ");
  EXPECT_EQ(fourth.channels.size(), 6);
  EXPECT_THAT(fourth.notes, Contains(HasSubstr("revision 1997")));
}

}  // namespace
}  // namespace swingbank::validate::record
