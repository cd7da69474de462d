# The installed library. find_package(swingbank) defines a target for each module that is not INTERNAL
# (swingbank::validate_fit) and three targets for groups of modules:
#   swingbank::simulation   effects, network and case files, simulators
#   swingbank::validation   records, playback, estimation, diagnosis, and the effects
#   swingbank::datasets     simulated datasets
# Headers are included by their paths in this repository: #include "validate/fit/fit.hpp".
set(SWINGBANK_INCLUDE ${CMAKE_INSTALL_INCLUDEDIR}/swingbank)
set(SWINGBANK_PACKAGE ${CMAKE_INSTALL_LIBDIR}/cmake/swingbank)

# swingbank_export(target path headers...): installs the archive and the public headers of a module.
function(swingbank_export target path)
  string(REPLACE / _ name ${path})
  target_include_directories(${target} INTERFACE $<INSTALL_INTERFACE:${SWINGBANK_INCLUDE}>)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${target} EXPORT swingbank ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/swingbank COMPONENT development)
  install(FILES ${ARGN} DESTINATION ${SWINGBANK_INCLUDE}/${path} COMPONENT development)
  set_property(GLOBAL APPEND PROPERTY SWINGBANK_EXPORTED ${target})
endfunction()

# swingbank_export_group(name REGEX): swingbank::<name> links the exported modules whose target names match.
function(swingbank_export_group name regex)
  get_property(modules GLOBAL PROPERTY SWINGBANK_EXPORTED)
  list(FILTER modules INCLUDE REGEX ${regex})
  add_library(swingbank_group_${name} INTERFACE)
  target_link_libraries(swingbank_group_${name} INTERFACE ${modules})
  set_target_properties(swingbank_group_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS swingbank_group_${name} EXPORT swingbank)
endfunction()

# Call this function after all modules are declared.
function(swingbank_install_package)
  swingbank_export_group(simulation "^swingbank_(base|sim_.*)$")
  swingbank_export_group(validation "^swingbank_(base|sim_(core|library|user_models|plant|grid)|validate_.*)$")
  swingbank_export_group(datasets "^swingbank_(base|mpi_store)$")
  foreach(target options hot cold)
    set_target_properties(swingbank_${target} PROPERTIES EXPORT_NAME ${target})
    install(TARGETS swingbank_${target} EXPORT swingbank)
  endforeach()
  # Effects outside the source tree can also use the building blocks of effects.
  install(DIRECTORY sim/effects/detail DESTINATION ${SWINGBANK_INCLUDE}/sim/effects COMPONENT development
    FILES_MATCHING PATTERN *.hpp)
  include(CMakePackageConfigHelpers)
  set(made ${PROJECT_BINARY_DIR}/package)
  write_basic_package_version_file(${made}/swingbankConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  file(CONFIGURE OUTPUT ${made}/version.hpp CONTENT
"#pragma once
// The version of the installed library. Within one minor version (0.2.x) programs compile and link unchanged.
#define SWINGBANK_VERSION_MAJOR @PROJECT_VERSION_MAJOR@
#define SWINGBANK_VERSION_MINOR @PROJECT_VERSION_MINOR@
#define SWINGBANK_VERSION_PATCH @PROJECT_VERSION_PATCH@
#define SWINGBANK_VERSION_STRING \"@PROJECT_VERSION@\"
" @ONLY)
  install(FILES ${made}/version.hpp DESTINATION ${SWINGBANK_INCLUDE} COMPONENT development)
  install(FILES cmake/swingbankConfig.cmake cmake/dependencies.cmake ${made}/swingbankConfigVersion.cmake
    DESTINATION ${SWINGBANK_PACKAGE} COMPONENT development)
  install(EXPORT swingbank NAMESPACE swingbank:: FILE swingbankTargets.cmake DESTINATION ${SWINGBANK_PACKAGE}
    COMPONENT development)
endfunction()
