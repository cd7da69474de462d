// Choice of BLAS kernels. A processor unknown to the library is tested by blas_kernels_full.sh with the whole
// program.
#include <gmock/gmock.h>

#include "base/problem.hpp"
#include "train/runtime/blas_check.hpp"
#include "train/runtime/blas_kernels.hpp"

namespace swingbank::train::runtime {
namespace {
using testing::AllOf;
using testing::HasSubstr;

constexpr Processor kSse{}, kAvx{true}, kAvx2{true, true}, kAvx512{true, true, true};
constexpr Processor kExcavator{true, true, false, true};

std::string restart_with(const Processor& p, const std::string& core) {
  const BlasChoice choice = choose_blas_kernels(p, {core, "", ""});
  EXPECT_EQ(choice.warning, "");
  return choice.restart_with;
}

TEST(BlasKernels, UnknownProcessorGetsTheWidestSupportedKernels) {
  for (const char* core : {"Prescott", "Nehalem", "Core2", "Barcelona", "Opteron_SSE3"}) {
    EXPECT_EQ(restart_with(kAvx512, core), "SKYLAKEX") << core;
    EXPECT_EQ(restart_with(kAvx2, core), "HASWELL") << core;
    EXPECT_EQ(restart_with(kAvx, core), "SANDYBRIDGE") << core;
    EXPECT_EQ(restart_with(kSse, core), "") << core;
  }
}

TEST(BlasKernels, ReplacesKernelsOfHalfTheWidth) {
  EXPECT_EQ(restart_with(kAvx512, "Haswell"), "SKYLAKEX");
  EXPECT_EQ(restart_with(kAvx512, "Zen"), "SKYLAKEX");
  EXPECT_EQ(restart_with(kAvx2, "Sandybridge"), "HASWELL");
}

TEST(BlasKernels, KeepsAGoodChoiceOfTheLibrary) {
  for (const char* core : {"SkylakeX", "Cooperlake", "SapphireRapids"})
    EXPECT_EQ(restart_with(kAvx512, core), "");
  for (const char* core : {"Haswell", "Zen"}) EXPECT_EQ(restart_with(kAvx2, core), "");
  EXPECT_EQ(restart_with(kAvx, "Sandybridge"), "");
  EXPECT_EQ(restart_with(kAvx512, "ArrowLakeOfALaterVersion"), "")
      << "what is not known is measured, not changed";
}

TEST(BlasKernels, KeepsTheUsersChoiceWithAWarning) {
  for (const auto& [core, asked] : {std::pair{"Prescott", "PRESCOTT"}, std::pair{"Haswell", "haswell"}}) {
    const BlasChoice choice = choose_blas_kernels(kAvx512, {core, asked, ""});
    EXPECT_EQ(choice.restart_with, "");
    EXPECT_THAT(choice.warning, AllOf(HasSubstr(core), HasSubstr(std::string("OPENBLAS_CORETYPE=") + asked),
                                      HasSubstr("AVX-512"), HasSubstr("unset")));
  }
  const BlasChoice good = choose_blas_kernels(kAvx512, {"SkylakeX", "SKYLAKEX", ""});
  EXPECT_EQ(good.restart_with + good.warning, "");
}

TEST(BlasKernels, RestartsTheProgramOnceOnly) {
  const BlasChoice choice = choose_blas_kernels(kAvx512, {"Prescott", "SKYLAKEX", "Prescott"});
  EXPECT_EQ(choice.restart_with, "");
  EXPECT_THAT(choice.warning, AllOf(HasSubstr("Prescott"), HasSubstr("SKYLAKEX was requested")));
  EXPECT_EQ(choose_blas_kernels(kAvx512, {"SkylakeX", "SKYLAKEX", "Prescott"}).warning, "");
}

TEST(BlasKernels, RefusesUnsupportedInstructionSets) {
  EXPECT_THROW(choose_blas_kernels(kAvx2, {"SkylakeX", "SKYLAKEX", ""}), InputError);
  EXPECT_THROW(choose_blas_kernels(kSse, {"Sandybridge", "SANDYBRIDGE", ""}), InputError);
  EXPECT_THROW(choose_blas_kernels(kAvx512, {"Piledriver", "PILEDRIVER", ""}), InputError);
  EXPECT_NO_THROW(choose_blas_kernels(kExcavator, {"Excavator", "EXCAVATOR", ""}));
}

TEST(BlasKernels, ReportsOtherLibrariesWithoutAChange) {
  const BlasChoice choice = choose_blas_kernels(kAvx512, {});
  EXPECT_EQ(choice.restart_with, "");
  EXPECT_THAT(choice.warning, HasSubstr("libopenblas0-openmp"));
}

TEST(BlasCheck, InstalledLibraryMultipliesCorrectly) { require_right_products(BlasFound::here()); }

TEST(BlasCheck, LibraryRateIsBelowTheProcessorsMultiplyAddRate) {
  const BlasRate& rate = blas_rate();
  EXPECT_GT(rate.product, 0.1);
  EXPECT_GT(rate.multiply_adds, 1.0);
  EXPECT_LT(rate.share(), 1.25)
      << "the products exceed the measured upper bound by more than the clock frequency may change";
}

TEST(BlasCheck, WarnsOfASlowLibrary) {
  const BlasRate prescott{44.0, 190.0}, skylake{172.0, 190.0};
  EXPECT_THAT(prescott.warning(),
              AllOf(HasSubstr("44 GFLOP/s"), HasSubstr("190 GFLOP/s"), HasSubstr("slow")));
  EXPECT_EQ(skylake.warning(), "");
}

}  // namespace
}  // namespace swingbank::train::runtime
