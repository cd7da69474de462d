#pragma once
// Entry points of the commands. jobs/<name>.cpp defines <name>_command; jobs/CMakeLists.txt says which
// program contains it.
#include "jobs/command_line.hpp"

namespace swingbank::jobs {

/// Declares the options on `line` (summary and name are set), parses the arguments and runs the command.
/// Returns the exit code: 0 success, 1 an error that was printed, others as the command's help states.
using CommandFunction = int(CommandLine& line, int argc, char** argv);

CommandFunction add_command, blind_test_command, calibrate_command, compare_command, configs_command,
    cross_validate_command, databank_command, diagnose_command, effects_command, export_command,
    generate_command, inventory_command, merge_command, night_plan_command, nightly_compare_command,
    plant_command, predict_command, simulate_command, tables_command, train_command, verify_command;

}  // namespace swingbank::jobs
