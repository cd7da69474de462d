#pragma once
// Encoding of text files, and recognition of binary files.
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::validate::record {

/// Returns the text without the characters `blank` at its ends.
std::string_view trimmed(std::string_view text, std::string_view blank = " ");
/// Removes the first line from `text` and returns it without its end, LF or CR LF.
std::string_view take_line(std::string_view& text);

/// Throws InputError if the bytes are not readable text. The error names their format (UTF-16, a spreadsheet,
/// a zip, a plant file, an output file of a simulator, …) and explains how to export a record.
void refuse_binary(std::string_view bytes, const std::string& name);

/// Returns the text as UTF-8. Other encodings are interpreted as Windows-1251 if letters beyond ASCII are
/// mostly adjacent, as in Cyrillic words, otherwise as Windows-1252. `notes` reports the choice.
std::string as_utf8(std::string_view text, std::vector<std::string>& notes);

}  // namespace swingbank::validate::record
