#pragma once
// Result files appear complete or not at all.
#include <filesystem>
#include <string>
#include <string_view>

namespace swingbank {

/// Makes the folder if needed, and writes as write_text does. Throws InputError (no permission, full disk),
/// leaving nothing under the final name that was not there before.
void write_file(const std::filesystem::path& file, std::string_view content);

}  // namespace swingbank
