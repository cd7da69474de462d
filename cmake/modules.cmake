# A module is a folder with one purpose. It becomes a target `swingbank_<path with _ for />`; its namespace is its
# path, and its tests are in tests/<path>.
#   swingbank_module(validate/fit [INTERNAL] [KIND hot|cold|train] [USES module...] [INSIDE module...] [LINK target...] [SOURCES file...])
# USES: modules whose headers this module's public headers include. INSIDE: modules that only its sources include.
# KIND: `hot` (default) is fully optimised; `cold` is not (readers, reports, commands); `train` includes LibTorch's
# headers. INTERNAL: not part of the installed library (find_package(swingbank)), which has every other module with
# its public headers.
# Files in <module>/detail/ are private: no other module can include them. Each module has two include roots in the
# build folder, made of links: `public` has its public headers, `own` the whole module. A target sees its own module
# and the public headers of the modules that it names; any other include does not compile.
function(swingbank_module path)
  cmake_parse_arguments(A "INTERNAL" "KIND" "USES;INSIDE;LINK;SOURCES" ${ARGN})
  string(REPLACE / _ name ${path})
  set(module swingbank_${name})
  set(folder ${PROJECT_SOURCE_DIR}/${path})
  set(roots ${PROJECT_BINARY_DIR}/modules/${name})
  file(REMOVE_RECURSE ${roots})
  cmake_path(GET path PARENT_PATH parent)
  file(MAKE_DIRECTORY ${roots}/own/${parent} ${roots}/public/${path})
  file(CREATE_LINK ${folder} ${roots}/own/${path} SYMBOLIC)
  file(GLOB headers CONFIGURE_DEPENDS ${folder}/*.hpp)
  foreach(header ${headers})
    cmake_path(GET header FILENAME file)
    file(CREATE_LINK ${header} ${roots}/public/${path}/${file} SYMBOLIC)
  endforeach()
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp ${folder}/detail/*.cpp)
  list(APPEND sources ${A_SOURCES})
  list(TRANSFORM A_USES REPLACE / _)
  list(TRANSFORM A_USES PREPEND swingbank_)
  list(TRANSFORM A_INSIDE REPLACE / _)
  list(TRANSFORM A_INSIDE PREPEND swingbank_)
  if(NOT A_KIND)
    set(A_KIND hot)
  endif()
  if(sources)
    add_library(${module} STATIC ${sources})
    target_include_directories(${module} BEFORE PRIVATE ${roots}/own)
    target_include_directories(${module} PUBLIC $<BUILD_INTERFACE:${roots}/public>)
    target_link_libraries(${module} PUBLIC swingbank_options ${A_USES} ${A_LINK} PRIVATE swingbank_${A_KIND} ${A_INSIDE})
    swingbank_precompile(${module} ${A_KIND})
  else()
    add_library(${module} INTERFACE)
    target_include_directories(${module} INTERFACE $<BUILD_INTERFACE:${roots}/public>)
    target_link_libraries(${module} INTERFACE swingbank_options ${A_USES} ${A_LINK})
  endif()
  set_property(GLOBAL APPEND PROPERTY SWINGBANK_MODULES ${module})
  if(NOT A_INTERNAL)
    swingbank_export(${module} ${path} ${headers})
  endif()
  set_property(TARGET ${module} PROPERTY SWINGBANK_INSIDE "${A_INSIDE}") # its tests see what its sources see
endfunction()
