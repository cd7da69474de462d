#pragma once
// Case-insensitive names: conversion to capital letters, and comparison.
#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace swingbank {

/// Returns `text` with its ASCII letters as capitals.
inline std::string capitals(std::string_view text) {
  std::string all(text);
  std::ranges::transform(all, all.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return all;
}
/// Returns true if two names are equal apart from the case of their ASCII letters.
inline bool same_name(std::string_view a, std::string_view b) {
  return std::ranges::equal(
      a, b, [](unsigned char x, unsigned char y) { return std::toupper(x) == std::toupper(y); });
}

}  // namespace swingbank
