# Program with all modules, for the one-definition rule: with -flto the linker compares the types of the same name in
# all modules. No command links all of them.
get_property(modules GLOBAL PROPERTY SWINGBANK_MODULES)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/all_modules.cpp CONTENT "int main() {}\n")
add_executable(all_modules ${PROJECT_BINARY_DIR}/all_modules.cpp)
target_link_libraries(all_modules PRIVATE swingbank_options ${modules})
swingbank_parallel_hdf5(all_modules)
foreach(module ${modules})
  get_target_property(type ${module} TYPE)
  if(type STREQUAL STATIC_LIBRARY)
    target_link_libraries(all_modules PRIVATE -Wl,--whole-archive $<TARGET_FILE:${module}> -Wl,--no-whole-archive)
    add_dependencies(all_modules ${module})
  endif()
endforeach()
