#pragma once
// A share that was counted, with its uncertainty.

namespace swingbank {

/// k of n with Wilson's 95 % interval (Wilson 1927, J. Am. Stat. Assoc. 22, 209).
struct Rate {
  int hits = 0, n = 0;
  void count(bool hit) {
    ++n;
    hits += hit ? 1 : 0;
  }
  [[nodiscard]] double value() const { return n > 0 ? static_cast<double>(hits) / n : 0.0; }
  [[nodiscard]] double low() const;
  [[nodiscard]] double high() const;
};

}  // namespace swingbank
