#pragma once
// Random keys and shuffles that are identical with every standard library.
#include <cstdint>
#include <random>
#include <vector>

namespace swingbank::train::data {

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014): a bijection that mixes all bits.
constexpr std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
/// Purpose of a random stream; part of its key, so that streams of different purposes differ.
enum class Purpose : std::uint64_t {
  weights = 1,
  dropout,
  order,
  split,
  labels,
  noise,
  noise_level,
  set_aside,
  selection
};
constexpr std::uint64_t key(std::uint64_t seed, Purpose purpose, std::uint64_t a = 0, std::uint64_t b = 0) {
  return mix(mix(mix(mix(seed) ^ static_cast<std::uint64_t>(purpose)) ^ a) ^ b);
}

/// Shuffles by Fisher and Yates. The order of std::shuffle would depend on the standard library.
template <class T>
void shuffle(T* values, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  for (std::size_t i = count; i > 1; --i) {
    const std::uint64_t limit = ~std::uint64_t{0} - ~std::uint64_t{0} % i;  // larger draws would cause a bias
    std::uint64_t draw = random();
    while (draw >= limit) draw = random();
    std::swap(values[i - 1], values[draw % i]);
  }
}
template <class T>
void shuffle(std::vector<T>& values, std::uint64_t seed) {
  shuffle(values.data(), values.size(), seed);
}

}  // namespace swingbank::train::data
