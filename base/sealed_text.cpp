#include "base/sealed_text.hpp"

#include <xxhash.h>

#include "base/durable.hpp"

namespace swingbank {

namespace {
std::string ending(std::string_view before) {
  return ",\"sum\":\"" + hex(XXH3_64bits(before.data(), before.size())) + "\"}";
}
}  // namespace

std::string sealed_text(std::string_view object) {
  const auto last = object.rfind('}');
  const auto before = object.substr(0, object.find_last_not_of(" \n", last == 0 ? 0 : last - 1) + 1);
  return std::string(before) + ending(before) + "\n";
}

bool is_sealed(std::string_view text) {
  if (text.ends_with('\n')) text.remove_suffix(1);
  const std::size_t length = ending("").size();
  if (text.size() < length) return false;
  const auto before = text.substr(0, text.size() - length);
  return text.substr(before.size()) == ending(before);
}

}  // namespace swingbank
