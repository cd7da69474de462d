#pragma once
// Entry points of the commands. jobs/<name>.cpp defines <name>_command; jobs/CMakeLists.txt says which
// program contains it.
#include "jobs/command_line.hpp"

namespace swingbank::jobs {

CommandFunction add_command, calibrate_command, compare_command, configs_command, cross_validate_command,
    databank_command, diagnose_command, diagnose_fleet_command, effects_command, export_command,
    generate_command, inventory_command, merge_command, plant_command, predict_command, serve_command,
    simulate_command, tables_command, train_command, verify_command;

}  // namespace swingbank::jobs
