#pragma once
// Text of a JSON Schema: short values on one line, others with a line for each part.
#include <string>

#include "base/json.hpp"

namespace swingbank {

/// Returns the schema as indented text that ends with a line break, because people read it too.
std::string schema_text(const nlohmann::ordered_json& schema);

}  // namespace swingbank
