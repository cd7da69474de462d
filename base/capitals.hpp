#pragma once
// Case-insensitive names: conversion to capital letters.
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

}  // namespace swingbank
