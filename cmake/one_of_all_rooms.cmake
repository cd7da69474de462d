# All modules in one program: with -flto the linker compares the types of each name across them (the one-definition
# rule). No single command links all of them.
get_property(rooms GLOBAL PROPERTY SWINGBANK_ROOMS)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/one_of_all_rooms.cpp CONTENT "int main() {}\n")
add_executable(one_of_all_rooms ${PROJECT_BINARY_DIR}/one_of_all_rooms.cpp)
target_link_libraries(one_of_all_rooms PRIVATE swingbank_options ${rooms})
foreach(room ${rooms})
  get_target_property(type ${room} TYPE)
  if(type STREQUAL STATIC_LIBRARY)
    target_link_libraries(one_of_all_rooms PRIVATE -Wl,--whole-archive $<TARGET_FILE:${room}> -Wl,--no-whole-archive)
    add_dependencies(one_of_all_rooms ${room})
  endif()
endforeach()
