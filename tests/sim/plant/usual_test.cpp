#include "sim/plant/usual.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "sim/library/library.hpp"

namespace swingbank::sim::plant {
namespace {

using ::testing::ElementsAre;

constexpr std::array kPss2Leads = {"T1", "T3", "T8", "T10", "T12"};

Block tgov1() {
  const Effect* effect = library::compiled().find("TGOV1");
  return {effect, effect->default_parameters()};
}

TEST(Usual, NamesValuesOutsideTheirRange) {
  Block block = tgov1();
  EXPECT_TRUE(unusual(block).empty());
  block.p[static_cast<std::size_t>(block.effect->parameter_index("VMIN"))] = -1.5;
  EXPECT_THAT(unusual_texts(block, "x.dyr:12"),
              ElementsAre("x.dyr:12: VMIN = -1.5 pu (usual range of TGOV1: -1 to 1 pu)"));
  block.p[static_cast<std::size_t>(block.effect->parameter_index("VMIN"))] = -999;
  EXPECT_TRUE(unusual(block).empty()) << "none";
}

TEST(Usual, DefaultsOfEveryEffectAreWithinTheirRange) {
  for (const Effect& e : library::compiled_effects())
    EXPECT_THAT(unusual({&e, e.default_parameters()}), ElementsAre()) << e.name;
}

TEST(Usual, SearchRangeIncludesAValueOutsideTheUsualRange) {
  Parameter p{};
  p.low = 0.05;
  p.high = 5.0;
  const auto range = [&](double value) {
    const SearchRange r = search_range(p, value);
    return std::pair(r.low, r.high);
  };
  EXPECT_EQ(range(1.0), std::pair(0.05, 5.0));
  EXPECT_EQ(range(7.0), std::pair(0.05, 7.0 + 4.95));
  EXPECT_EQ(range(0.01), std::pair(0.0, 5.0)) << "a positive quantity stays positive";
  EXPECT_EQ(range(-1.0), std::pair(-1.0 - 4.95, 5.0));
  p.low = -1.0;
  p.high = 1.0;
  EXPECT_EQ(range(-1.5), std::pair(-3.5, 1.0));
}

/// Lead time constants: a negative one is a zero in the right half-plane, which the equations allow.
bool is_lead(const std::string& name) {
  constexpr std::array leads = {"TC",        "TC1",       "TJ",        "TK",        "TU1",       "TU3",
                                "IEEEST.T1", "IEEEST.T3", "IEEEST.T5", "ST2CUT.T5", "ST2CUT.T7", "ST2CUT.T9"};
  const std::string own = name.substr(name.find('.') + 1);
  const bool of_pss2 = name.starts_with("PSS2") && std::ranges::count(kPss2Leads, own) > 0;
  const bool of_tgov3 = name.starts_with("TGOV3");  // its TC is no lead
  return of_pss2 ||
         (!of_tgov3 && (std::ranges::count(leads, own) > 0 || std::ranges::count(leads, name) > 0));
}
/// Parameters of the files that no equation uses.
bool is_unread(const std::string& name) {
  constexpr std::array unread = {"Switch", "IB",   "REMBUS1", "REMBUS2", "RemoteBus", "FromBus",
                                 "ToBus",  "BUSR", "BUSR2",   "Circuit", "Accel",     "Tcomp"};
  const std::string own = name.substr(name.find('.') + 1);
  return std::ranges::count(unread, own) > 0 || name.starts_with("ST5B.TO") || name.starts_with("ST5B.TU") ||
         name == "TGOV3.TA" || name == "TGOV3.TB" || name == "TGOV3.TC" || name == "REECC1.T" ||
         name == "PMUFILTER.reports";
}

/// Ranges only warn. The effect's own check must refuse negative times and unknown codes.
TEST(Usual, RefusesNegativeTimesAndUnknownCodes) {
  for (const Effect& e : library::compiled_effects())
    for (std::size_t i = 0; i < e.parameters.size(); ++i) {
      const Parameter& record = e.parameters[i];
      const bool time = record.unit == "s" && record.low >= 0;
      const std::string name = std::string(e.name) + "." + std::string(record.name);
      if ((!time && !record.is_code()) || is_lead(name) || is_unread(name)) continue;
      for (const double value : {time ? -1.0 : 0.5, time ? -1e-3 : record.high + 1}) {
        auto p = e.default_parameters();
        p[i] = value;
        Problems problems;
        e.check(e.user_model.get(), p.data(), "x", problems);
        EXPECT_FALSE(problems.empty()) << name << " = " << value;
      }
    }
}

}  // namespace
}  // namespace swingbank::sim::plant
