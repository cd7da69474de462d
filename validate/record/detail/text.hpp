#pragma once
// Lines of text files, and recognition of binary files.
#include <string>
#include <string_view>

namespace swingbank::validate::record {

/// Returns the text without the characters `blank` at its ends.
std::string_view trimmed(std::string_view text, std::string_view blank = " ");
/// Removes the first line from `text` and returns it without its end, LF or CR LF.
std::string_view take_line(std::string_view& text);

/// Throws InputError if the bytes are not readable text. The error names their format (UTF-16, a spreadsheet,
/// a zip, a plant file, an output file of a simulator, …) and explains how to export a record.
void refuse_binary(std::string_view bytes, const std::string& name);

}  // namespace swingbank::validate::record
