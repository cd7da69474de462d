#pragma once
// Entry points of the commands of this folder; CMakeLists.txt says which program contains each.
#include "jobs/command_line.hpp"

namespace swingbank::research {

jobs::CommandFunction blind_test_command, night_plan_command, nightly_compare_command;

}  // namespace swingbank::research
