#pragma once
// Version and commit of this software, determined at build time (cmake/commit.cmake).
namespace swingbank::jobs {

const char* version();  ///< "0.2.0"
const char* commit();   ///< "1a2b3c4d5e6f", with "-dirty" if the sources differ from the commit

}  // namespace swingbank::jobs
