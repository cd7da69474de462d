# Debian packages: `cpack -G DEB` in the build folder builds one package per component of install.cmake.
#   swingbank           commands without datasets and networks, example configs, documents
#   swingbank-train     programs of datasets and networks, with MPI and LibTorch
#   libswingbank-dev    library and headers
#   python3-swingbank   Python package
#   swingbank-x86-64-v3, swingbank-x86-64-v4    commands of swingbank for wider instruction sets, if they were built
# debian_files.cmake writes the files that only a package has. debian_size.cmake corrects the size that CPack states.
# dpkg-shlibdeps finds the packages of the shared libraries.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME swingbank)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each package has its own summary
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_COMPRESSION_TYPE zstd) # fastest method; debian_size.cmake compresses again
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake)
set(CPACK_POST_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_size.cmake)
set(CPACK_SWINGBANK_SOURCE ${PROJECT_SOURCE_DIR}) # for both scripts
file(STRINGS CITATION.cff authors REGEX "^  - name: ")
string(REGEX REPLACE ".*\"(.*)\"" "\\1" CPACK_DEBIAN_PACKAGE_MAINTAINER "${authors}")
set(same "swingbank (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")

# swingbank_package(component name "synopsis" "description"): declares the package of a component
macro(swingbank_package component name synopsis description)
  string(TOUPPER ${component} upper)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${synopsis}\n${description}")
endmacro()

set(about "Swingbank plays recorded disturbances into the dynamic model of a power
plant, compares the simulated with the recorded power, and names the
component that the model lacks.
.")
set(CPACK_COMPONENTS_ALL)
swingbank_package(swingbank swingbank "power-plant model validation" "${about}
This package contains the commands and the example configs.")

set(CPACK_DEBIAN_SWINGBANK_PACKAGE_SUGGESTS "swingbank-x86-64-v3, swingbank-x86-64-v4")

# When cpack runs, debian_levels.cmake removes the components whose programs were not built.
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/debian_levels.cmake)
set(CPACK_SWINGBANK_PROGRAMS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
foreach(level_of "v3;AVX2" "v4;AVX-512")
  list(GET level_of 0 level)
  list(GET level_of 1 instructions)
  swingbank_package(${level} swingbank-x86-64-${level} "power-plant model validation with ${instructions}" "${about}
This package contains the commands for processors with ${instructions}. The
command swingbank selects the commands for the processor.")
  string(TOUPPER ${level} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS ${same})
endforeach()

swingbank_package(train swingbank-train "datasets and networks for power-plant model validation" "${about}
This package contains the commands that simulate datasets, with MPI, and
train networks on them, with LibTorch.")
set(CPACK_DEBIAN_TRAIN_PACKAGE_DEPENDS ${same})
set(CPACK_DEBIAN_TRAIN_PACKAGE_RECOMMENDS "openmpi-bin, libopenblas0-openmp")

swingbank_package(development libswingbank-dev "library for power-plant model validation" "${about}
This package contains the static libraries and headers, for
find_package(swingbank) in CMake.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
file(STRINGS packages.txt library REGEX "# library:")
list(TRANSFORM library REPLACE "[ #].*" "")
list(JOIN library ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)

if(SWINGBANK_PYTHON_FOUND)
  swingbank_package(python python3-swingbank "Python package for power-plant model validation" "${about}
This package contains the Python package swingbank, which runs the library
in the interpreter's process.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  math(EXPR next "${Python_VERSION_MINOR} + 1") # the extension works with one minor version of Python only
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "${same}, python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy, python3-h5py")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/debian/postinst
    ${PROJECT_SOURCE_DIR}/packaging/debian/prerm)
endif()
include(CPack)
