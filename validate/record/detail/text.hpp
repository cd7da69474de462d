#pragma once
// What bytes of a text file mean: its encoding, and files that are no text at all.
#include <string>
#include <string_view>
#include <vector>

namespace swingbank::validate::record {

/// Throws InputError that names what the bytes are (UTF-16, a spreadsheet, a zip, a plant file, an output
/// file of a simulator, …) and how to export it, if they are no text that can be read.
void refuse_binary(std::string_view bytes, const std::string& name);

/// Text as UTF-8. What is no UTF-8 is Windows-1251 where most of its letters are Cyrillic in that, otherwise
/// Windows-1252; `notes` says which.
std::string as_utf8(std::string_view text, std::vector<std::string>& notes);

}  // namespace swingbank::validate::record
