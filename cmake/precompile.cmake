# Precompiled headers: headers that most sources include, parsed once per kind of target. A build without them
# (SWINGBANK_PRECOMPILE=OFF) reveals missing includes.
option(SWINGBANK_PRECOMPILE "Parse the headers of the standard library, fmt, Eigen and others once" ON)

# swingbank_precompiled(kind targets... HEADERS <header>...): precompiles headers with the include folders and options
# of the targets.
function(swingbank_precompiled kind)
  cmake_parse_arguments(A "" "" "HEADERS" ${ARGN})
  if(NOT SWINGBANK_PRECOMPILE)
    return()
  endif()
  set(unit ${PROJECT_BINARY_DIR}/precompiled/${kind}.cpp)
  file(CONFIGURE OUTPUT ${unit} CONTENT "// Generated: holds the precompiled headers '${kind}'.\n")
  add_library(swingbank_precompiled_${kind} OBJECT ${unit})
  target_link_libraries(swingbank_precompiled_${kind} PRIVATE ${A_UNPARSED_ARGUMENTS})
  target_precompile_headers(swingbank_precompiled_${kind} PRIVATE ${A_HEADERS})
endfunction()

# swingbank_precompile(target kind): uses the precompiled headers of a kind in a target.
function(swingbank_precompile target kind)
  if(TARGET swingbank_precompiled_${kind})
    target_precompile_headers(${target} REUSE_FROM swingbank_precompiled_${kind})
  endif()
endfunction()

set(standard <algorithm> <array> <cmath> <complex> <filesystem> <functional> <map> <memory> <numbers> <optional> <ranges>
  <set> <span> <string> <string_view> <utility> <vector> <fmt/format.h>)
swingbank_precompiled(hot swingbank_hot HEADERS ${standard} <Eigen/Dense>)
swingbank_precompiled(cold swingbank_cold HEADERS ${standard} <fstream> <sstream> ${PROJECT_SOURCE_DIR}/base/json.hpp)
