# Configuration for find_package(swingbank); export.cmake describes the targets.
if(NOT CMAKE_C_COMPILER_LOADED)
  enable_language(C) # for the search of HDF5
endif()
include(${CMAKE_CURRENT_LIST_DIR}/dependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/swingbankTargets.cmake)
