# Writes a source file with the version and a hash of the sources that determine a result. The hash ignores comments and
# blanks. Call: cmake -D VERSION=... -D OUT=... -D LIST=file-with-one-path-a-line -P code_hash.cmake
cmake_minimum_required(VERSION 3.25)
file(STRINGS ${LIST} files)
set(all "")
foreach(file ${files})
  file(READ ${file} text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REGEX REPLACE "[ \t\r\n]+" "" text "${text}")
  string(SHA256 one "${text}")
  string(APPEND all ${one})
endforeach()
string(SHA256 hash "${all}")
string(SUBSTRING ${hash} 0 12 hash)
file(CONFIGURE OUTPUT ${OUT} CONTENT
"// Made by cmake/code_hash.cmake.
#include \"train/run/detail/maker.hpp\"

namespace swingbank::train::run {
const char* software() { return \"swingbank @VERSION@, code @hash@\"; }
}  // namespace swingbank::train::run
" @ONLY)
