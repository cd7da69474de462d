# One function per kind of target, so that each folder's CMakeLists.txt only names its files.
add_library(swingbank_options INTERFACE)
target_include_directories(swingbank_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(swingbank_options INTERFACE -Wall -Wextra -Wshadow
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> # GCC 12 warns falsely about std::string concatenation
  -fno-math-errno -fno-trapping-math
  $<$<NOT:$<CONFIG:Debug>>:-O3>)
# Events, hypotheses and ranks share the cores; Eigen's own threads would spin beside them.
target_compile_definitions(swingbank_options INTERFACE EIGEN_DONT_PARALLELIZE)
# GCC 12's avx512fintrin.h trips this one wherever Eigen multiplies matrices (GCC bug 105593).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(swingbank_options INTERFACE -Wno-maybe-uninitialized)
endif()
if(SWINGBANK_ARCH)
  target_compile_options(swingbank_options INTERFACE -march=${SWINGBANK_ARCH})
endif()
if(SWINGBANK_COUNT_FLOPS)
  target_compile_definitions(swingbank_options INTERFACE SWINGBANK_COUNT_FLOPS)
endif()
if(SWINGBANK_WERROR)
  target_compile_options(swingbank_options INTERFACE -Werror)
endif()
if(SWINGBANK_SANITIZE)
  target_compile_options(swingbank_options INTERFACE -fsanitize=${SWINGBANK_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(swingbank_options INTERFACE -fsanitize=${SWINGBANK_SANITIZE})
endif()

# swingbank_library(name sources... LINK targets...)
function(swingbank_library name)
  cmake_parse_arguments(A "" "" "LINK" ${ARGN})
  add_library(${name} STATIC ${A_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PUBLIC swingbank_options ${A_LINK})
endfunction()

# swingbank_command(name SUMMARY "one line" LINK targets...): jobs/<name>.cpp becomes bin/swingbank-<name>.
# The summary stands here only: `swingbank --help` lists it, the command gets it as SWINGBANK_SUMMARY.
function(swingbank_command name)
  cmake_parse_arguments(A "" "SUMMARY" "LINK" ${ARGN})
  string(REPLACE "-" "_" file ${name})
  add_executable(swingbank-${name} ${file}.cpp)
  target_link_libraries(swingbank-${name} PRIVATE swingbank_options CLI11::CLI11 ${A_LINK})
  target_compile_definitions(swingbank-${name} PRIVATE SWINGBANK_SUMMARY="${A_SUMMARY}")
  set_property(GLOBAL APPEND_STRING PROPERTY SWINGBANK_COMMANDS "{\"${name}\", \"${A_SUMMARY}\"},\n")
endfunction()

# Writes the table of all commands, in the order they were declared, for the dispatcher.
function(swingbank_command_table)
  get_property(table GLOBAL PROPERTY SWINGBANK_COMMANDS)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/commands.inc CONTENT "${table}" @ONLY)
endfunction()
