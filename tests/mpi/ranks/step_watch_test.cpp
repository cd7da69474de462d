// A step that takes too long is reported once, with the last system error; one that ends in time is not.
#include "mpi/ranks/detail/step_watch.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>

#include <cerrno>
#include <thread>

namespace swingbank::mpi::ranks {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

TEST(StepWatch, ReportsAStepThatHangs) {
  testing::internal::CaptureStderr();
  {
    const StepWatch watch(3, "create", "shards/0.h5", milliseconds(20));
    EXPECT_EQ(::open("/", O_WRONLY), -1);  // last system error of the step
    std::this_thread::sleep_for(milliseconds(400));
    EXPECT_EQ(::open("", O_RDONLY), -1);
  }
  EXPECT_EQ(errno, ENOENT);
  const std::string message = testing::internal::GetCapturedStderr();
  EXPECT_THAT(message,
              HasSubstr("rank 3 has tried to create shards/0.h5 for 0.02 s; the system: Is a directory"));
  EXPECT_EQ(message.find("rank 3"), message.rfind("rank 3"));
}

TEST(StepWatch, IgnoresStepsThatEnd) {
  testing::internal::CaptureStderr();
  for (int k = 0; k < 300; ++k) const StepWatch watch(0, "close", "shards/0.h5");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace swingbank::mpi::ranks
