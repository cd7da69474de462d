# Compiler flags, and the declaration of commands.
# swingbank_options contains the options on which Eigen's alignment and inline functions depend; programs that link the
# installed library need them too. swingbank_build contains the other options.
add_library(swingbank_options INTERFACE)
add_library(swingbank_build INTERFACE)
target_link_libraries(swingbank_options INTERFACE $<BUILD_INTERFACE:swingbank_build>)
target_compile_features(swingbank_options INTERFACE cxx_std_20)
target_compile_options(swingbank_options INTERFACE -fno-math-errno -fno-trapping-math)
target_compile_options(swingbank_build INTERFACE -Wall -Wextra -Wshadow
  $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>) # ccache needs it with precompiled headers
# Events, hypotheses and ranks run in parallel; Eigen's own threads would compete with them for the cores.
target_compile_definitions(swingbank_options INTERFACE EIGEN_DONT_PARALLELIZE)
# With precompiled headers, GCC 12 gives false warnings: about avx512fintrin.h for Eigen's matrix products (GCC bug
# 105593), and about concatenations of std::string (bug 105329). clang (tests/fuzz, clang-tidy) still reports them.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(swingbank_build INTERFACE -Wno-maybe-uninitialized -Wno-uninitialized -Wno-array-bounds
    -Wno-stringop-overflow -Wno-stringop-overread -Wno-restrict)
endif()
if(SWINGBANK_ARCH)
  target_compile_options(swingbank_options INTERFACE -march=${SWINGBANK_ARCH})
endif()
if(SWINGBANK_COUNT_FLOPS)
  target_compile_definitions(swingbank_build INTERFACE SWINGBANK_COUNT_FLOPS)
endif()
# The Python extension is a shared library. This option lets the compiler inline functions there too.
if(SWINGBANK_PYTHON_FOUND)
  target_compile_options(swingbank_build INTERFACE -fPIC -fno-semantic-interposition)
endif()
if(SWINGBANK_WERROR)
  target_compile_options(swingbank_build INTERFACE -Werror)
endif()
# LLVM's linker, if available, links the same programs in a fifth of the time. It does not support GCC's link-time
# optimisation.
find_program(LLD ld.lld)
if(LLD AND NOT SWINGBANK_ODR)
  target_link_options(swingbank_build INTERFACE -fuse-ld=lld)
endif()
if(SWINGBANK_SANITIZE)
  target_compile_options(swingbank_options INTERFACE -fsanitize=${SWINGBANK_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(swingbank_options INTERFACE -fsanitize=${SWINGBANK_SANITIZE})
endif()
if(SWINGBANK_FUZZ)
  target_compile_options(swingbank_build INTERFACE -fsanitize=fuzzer-no-link -fno-sanitize-recover=undefined -Wno-psabi)
endif()

# Three kinds of sources: `hot` is simulation and fitting; `cold` is input, output and messages; `train` is LibTorch
# code. Cold sources need at least -O2: a program contains each inline function once, compiled with the options of
# either kind. Below -O2, GCC generates no fused multiply-adds, so the last bit of a result would depend on the linker's
# choice.
add_library(swingbank_hot INTERFACE)
target_compile_options(swingbank_hot INTERFACE $<$<NOT:$<CONFIG:Debug>>:-O3>)
target_link_libraries(swingbank_hot INTERFACE swingbank_options fmt::fmt Eigen3::Eigen OpenMP::OpenMP_CXX)
add_library(swingbank_cold INTERFACE)
target_compile_options(swingbank_cold INTERFACE $<$<NOT:$<CONFIG:Debug>>:-O2>)
target_link_libraries(swingbank_cold INTERFACE swingbank_options fmt::fmt nlohmann_json::nlohmann_json OpenMP::OpenMP_CXX)
add_library(swingbank_train INTERFACE)
target_link_libraries(swingbank_train INTERFACE swingbank_options fmt::fmt nlohmann_json::nlohmann_json OpenMP::OpenMP_CXX)
target_compile_options(swingbank_train INTERFACE $<$<NOT:$<CONFIG:Debug>>:-O3>)

# swingbank_parallel_hdf5(targets...): links parallel HDF5 for these targets, which use mpi/ranks. All others link
# serial HDF5.
function(swingbank_parallel_hdf5)
  set_target_properties(${ARGN} PROPERTIES SWINGBANK_PARALLEL_HDF5 ON)
endfunction()

# swingbank_own_headers(folder): creates the include folder modules/<folder>/own with the headers of a folder of
# commands.
function(swingbank_own_headers folder)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/modules/${folder}/own)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/modules/${folder}/own/${folder} SYMBOLIC)
endfunction()

# swingbank_program(name [KIND train] [COMPONENT component]): declares bin/<name>, a program with several commands of
# this folder (jobs/run_command.cpp). It is installed if it has a component (install.cmake).
function(swingbank_program name)
  cmake_parse_arguments(A "" "KIND;COMPONENT" "" ${ARGN})
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
  add_executable(${name} ${PROJECT_SOURCE_DIR}/jobs/run_command.cpp)
  target_link_libraries(${name} PRIVATE swingbank_cold swingbank_command_line)
  target_compile_definitions(${name} PRIVATE SWINGBANK_VERSION="${PROJECT_VERSION}")
  target_include_directories(${name} PRIVATE ${PROJECT_BINARY_DIR}/modules/${folder}/own ${PROJECT_BINARY_DIR}/commands/${name})
  set_target_properties(${name} PROPERTIES SWINGBANK_NAMESPACE swingbank::${folder})
  if(NOT A_KIND STREQUAL "train")
    swingbank_precompile(${name} cold)
  endif()
  if(A_COMPONENT)
    set_property(GLOBAL APPEND PROPERTY SWINGBANK_PROGRAMS_${A_COMPONENT} ${name})
    set_target_properties(${name} PROPERTIES SWINGBANK_COMPONENT ${A_COMPONENT})
  endif()
  set_property(GLOBAL APPEND PROPERTY SWINGBANK_MULTI_COMMAND_PROGRAMS ${name})
endfunction()

# swingbank_command(name IN program SUMMARY "one line" GROUP "heading" USES modules... [SOURCES files...]):
# <name>.cpp, with the function <name>_command::run, becomes a command of the program, started as bin/swingbank-<name>.
# `swingbank --help` lists the summary under the heading. The target swingbank-<name> builds the program.
function(swingbank_command name)
  cmake_parse_arguments(A "" "IN;SUMMARY;GROUP" "USES;SOURCES" ${ARGN})
  string(REPLACE - _ file ${name})
  list(TRANSFORM A_USES REPLACE / _)
  list(TRANSFORM A_USES PREPEND swingbank_)
  target_sources(${A_IN} PRIVATE ${file}.cpp ${A_SOURCES})
  target_link_libraries(${A_IN} PRIVATE ${A_USES})
  add_custom_target(swingbank-${name} DEPENDS ${A_IN})
  file(MAKE_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
  file(CREATE_LINK ${A_IN} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/swingbank-${name} SYMBOLIC)
  get_target_property(namespace ${A_IN} SWINGBANK_NAMESPACE)
  set_property(TARGET ${A_IN} APPEND_STRING PROPERTY SWINGBANK_COMMANDS "{\"${name}\", \"${A_SUMMARY}\", ${namespace}::${file}_command::run},\n")
  set_property(TARGET ${A_IN} APPEND_STRING PROPERTY SWINGBANK_DECLARATIONS "namespace ${namespace}::${file}_command { jobs::CommandFunction run; }\n")
  get_target_property(component ${A_IN} SWINGBANK_COMPONENT)
  if(NOT component)
    set(component "")
  endif()
  set_property(GLOBAL APPEND_STRING PROPERTY SWINGBANK_COMMANDS "{\"${name}\", \"${A_SUMMARY}\", \"${A_GROUP}\", \"${component}\"},\n")
  if(component)
    set_property(GLOBAL APPEND PROPERTY SWINGBANK_COMMAND_LINKS_${component} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/swingbank-${name})
  endif()
endfunction()

# Writes the tables of the commands, in the order of declaration: one with all commands for the dispatcher, and one for
# each program.
function(swingbank_command_tables)
  get_property(table GLOBAL PROPERTY SWINGBANK_COMMANDS)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/commands/commands.inc CONTENT "${table}" @ONLY)
  get_property(programs GLOBAL PROPERTY SWINGBANK_MULTI_COMMAND_PROGRAMS)
  foreach(program ${programs})
    get_target_property(table ${program} SWINGBANK_COMMANDS)
    get_target_property(declarations ${program} SWINGBANK_DECLARATIONS)
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/commands/${program}/commands_of_program.inc CONTENT "${table}" @ONLY)
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/commands/${program}/declarations.inc CONTENT "${declarations}" @ONLY)
  endforeach()
endfunction()

# swingbank_embed(target header function files...): embeds files in a target. `function` contains the return type and
# the name of a function that the header declares; it returns a file's name and content by its name.
function(swingbank_embed target header function)
  set(places "")
  set(symbols "")
  set(names "")
  foreach(file ${ARGN})
    cmake_path(GET file FILENAME name)
    string(MAKE_C_IDENTIFIER page_${name} symbol)
    string(APPEND places "    \".global ${symbol}\\n${symbol}:\\n.incbin \\\"${file}\\\"\\n.global ${symbol}_end\\n${symbol}_end:\\n.byte 0\\n\"\n")
    string(APPEND symbols "extern \"C\" const char ${symbol}[], ${symbol}_end[];\n")
    string(APPEND names "  if (name == \"${name}\") return {name, {${symbol}, static_cast<std::size_t>(${symbol}_end - ${symbol})}};\n")
  endforeach()
  set(out ${CMAKE_CURRENT_BINARY_DIR}/${target}_files.cpp)
  file(CONFIGURE OUTPUT ${out} CONTENT "// Made by swingbank_embed of cmake/targets.cmake.
#include \"@header@\"

asm(\".section .rodata\\n\"
@places@    \".previous\\n\");
@symbols@
@function@(std::string_view name) {
@names@  return {};
}
" @ONLY)
  # A separate object file, because a unity source would not have these dependencies.
  set_source_files_properties(${out} PROPERTIES OBJECT_DEPENDS "${ARGN}" SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${target} PRIVATE ${out})
endfunction()
