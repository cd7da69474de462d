#pragma once
// JSON as text. A file's name need not be UTF-8: what is not is replaced, so that no result is lost for it.
#include <nlohmann/json.hpp>
#include <string>

namespace swingbank {

inline std::string json_text(const nlohmann::json& j, int indent = -1) {
  return j.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace swingbank
