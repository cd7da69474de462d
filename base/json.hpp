#pragma once
// JSON as every source reads and writes it: nlohmann's, with whole numbers that are whole, and as text.
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>

/// The library casts: 1e95 as a count is undefined, 1.5 becomes 1, -1 becomes 2^64 - 1 and true becomes 1.
/// Here a whole number is one that was written as such and fits; anything else throws type_error. Sources
/// include this file and not the library's, so that no two of them read differently; so do the precompiled
/// headers, in which clang instantiates (and would take the library's own).
template <class T>
struct nlohmann::adl_serializer<T, std::enable_if_t<std::is_integral_v<T> && !std::is_same_v<T, bool>>> {
  template <class Json>
  static void from_json(const Json& j, T& value) {
    const auto take = [&](auto number) {
      if (std::in_range<T>(number)) return value = static_cast<T>(number), true;
      return false;
    };
    if (j.is_number_unsigned()
            ? take(j.template get_ref<const typename Json::number_unsigned_t&>())
            : j.is_number_integer() && take(j.template get_ref<const typename Json::number_integer_t&>()))
      return;
    using Limits = std::numeric_limits<T>;
    throw Json::type_error::create(302,
                                   "a whole number of " + std::to_string(Limits::min()) + " to " +
                                       std::to_string(Limits::max()) + " is expected, not " +
                                       (j.is_number() ? j.dump() : j.type_name()),
                                   &j);
  }
  template <class Json>
  static void to_json(Json& j, T value) {
    nlohmann::to_json(j, value);
  }
};

namespace swingbank {

/// A file's name need not be UTF-8: what is not is replaced, so that no result is lost for it.
inline std::string json_text(const nlohmann::json& j, int indent = -1) {
  return j.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace swingbank
