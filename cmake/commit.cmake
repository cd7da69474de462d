# Writes a source file with the version and the commit of the build: cmake -D VERSION=... -D SOURCE=... -D OUT=... -P
# commit.cmake
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --match=none
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed OR commit STREQUAL "")
  set(commit "unknown (built outside a repository)")
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT
"// Made by cmake/commit.cmake.
#include \"jobs/software.hpp\"

namespace swingbank::jobs {
const char* version() { return \"@VERSION@\"; }
const char* commit() { return \"@commit@\"; }
}  // namespace swingbank::jobs
" @ONLY)
