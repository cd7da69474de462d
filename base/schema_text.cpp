#include "base/schema_text.hpp"

namespace swingbank {
namespace {

constexpr std::size_t kLongestLine = 110;

void write_indented(const nlohmann::ordered_json& value, std::size_t indent, std::string& text) {
  const std::string line = value.dump();
  if (!value.is_structured() || value.empty() || indent + line.size() <= kLongestLine) {
    text += line;
    return;
  }
  const std::string margin(indent + 1, ' ');
  const char* between = "\n";
  text += value.is_object() ? '{' : '[';
  for (const auto& [name, part] : value.items()) {
    text += between + margin;
    if (value.is_object()) text += nlohmann::ordered_json(name).dump() + ": ";
    write_indented(part, indent + 1, text);
    between = ",\n";
  }
  text += "\n" + std::string(indent, ' ') + (value.is_object() ? '}' : ']');
}

}  // namespace

std::string schema_text(const nlohmann::ordered_json& schema) {
  std::string text;
  write_indented(schema, 0, text);
  return text + "\n";
}

}  // namespace swingbank
