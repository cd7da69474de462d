#pragma once
// JSON reading and writing: nlohmann's library with range-checked conversion of integers.
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>

/// Conversion of JSON numbers to integers. The library's own conversion is a cast: 1.5 becomes 1, -1 becomes
/// 2^64 - 1, true becomes 1, and for 1e95 the behaviour is undefined. This conversion accepts only an integer
/// that fits into T, and throws type_error otherwise. All sources and the precompiled headers include this
/// file, never the library's header alone. Thus every translation unit uses the same conversion, also with
/// clang, which instantiates templates in precompiled headers.
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

/// Returns JSON as text. Bytes that are not UTF-8 (a file name may contain some) are replaced, so that no
/// result is lost.
inline std::string json_text(const nlohmann::json& j, int indent = -1) {
  return j.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace swingbank
