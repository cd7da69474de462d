#include "sim/formats/detail/pslf_text.hpp"

#include <algorithm>
#include <cctype>

#include "sim/formats/psse_text.hpp"

namespace swingbank::sim::formats::pslf {

std::string lower(std::string_view text) {
  std::string all(text);
  std::ranges::transform(all, all.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return all;
}

bool says_nothing(const std::string& line) {
  const auto first = line.find_first_not_of(" \t\r");
  return first == std::string::npos || line[first] == '#' || line[first] == '@';
}

std::vector<Token> tokens_of(const std::string& text, const std::string& where, Problems& problems) {
  std::vector<Token> tokens;
  for (std::size_t i = 0; i < text.size();) {
    if (std::isspace(static_cast<unsigned char>(text[i])) != 0) {
      ++i;
    } else if (text[i] == '"') {
      const auto end = text.find('"', i + 1);
      if (end == std::string::npos)
        problems.add("a quote is not closed", where, "the text has no end", "close it");
      tokens.push_back({text.substr(i + 1, end == std::string::npos ? end : end - i - 1), true});
      i = end == std::string::npos ? text.size() : end + 1;
    } else {
      std::size_t end = i + 1;
      while (text[i] != ':' && end < text.size() && text[end] != '"' && text[end] != ':' &&
             std::isspace(static_cast<unsigned char>(text[end])) == 0)
        ++end;
      tokens.push_back({text.substr(i, end - i), false});
      i = end;
    }
  }
  return tokens;
}

Line record_at(const std::vector<std::string>& lines, std::size_t& at, std::size_t end,
               const std::string& file, Problems& problems) {
  Line record{static_cast<int>(at) + 1, false, {}, {}};
  bool goes_on = true;
  for (bool first = true; goes_on && at < end; ++at) {
    if (says_nothing(lines[at])) continue;
    std::string text = psse::trimmed(lines[at]);
    goes_on = text.back() == '/';
    if (goes_on) text.pop_back();
    if (!first) record.starts.push_back(record.tail.size());
    first = false;
    for (Token& token : tokens_of(text, file + ":" + std::to_string(at + 1), problems))
      if (!record.colon && !token.quoted && token.text == ":")
        record.colon = true;
      else
        (record.colon ? record.tail : record.head).push_back(std::move(token));
  }
  return record;
}

}  // namespace swingbank::sim::formats::pslf
