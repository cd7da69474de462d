#pragma once
// Which software a command is: made when it is built (cmake/commit.cmake).
namespace swingbank::jobs {

const char* version();  ///< "0.1.0"
const char* commit();   ///< "1a2b3c4d5e6f", with "-dirty" where sources differ from it

}  // namespace swingbank::jobs
