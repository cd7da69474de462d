#pragma once
// A small .raw file in parts, and helpers of the reader tests.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>

#include "base/problem.hpp"
#include "sim/formats/psse.hpp"
#include "sim/network/network.hpp"

namespace swingbank::sim::formats {

/// File that is removed with the object.
class ScratchFile {
 public:
  ScratchFile(const std::string& name, const std::string& text) : ScratchFile(name) {
    std::ofstream(path) << text;
  }
  explicit ScratchFile(const std::string& name) {
    folder_ = std::filesystem::temp_directory_path() /
              ("swingbank-" + std::to_string(::getpid()) + "-" + std::to_string(next()++));
    std::filesystem::create_directories(folder_);
    path = folder_ / name;
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() { std::filesystem::remove_all(folder_); }
  std::filesystem::path path;

 private:
  static int& next() {
    static int counter = 0;
    return counter;
  }
  std::filesystem::path folder_;
};

/// Three buses, two generators, one load, two lines. Parts may be replaced; `other` fills sections by name.
struct RawCase {
  int version = 33;
  std::string header_rest = ", 0, 1, 60.0 / a comment";
  std::string buses =
      "101,'NORTH', 138.0,3,1,1,1,1.05,0.0,1.1,0.9,1.1,0.9\n"
      "102,'EAST',138.0,2,1,1,1,1.02,-0.9,1.1,0.9,1.1,0.9\n"
      "103,'SOUTH',138.0,1,1,1,1,0.99,-8.7,1.1,0.9,1.1,0.9\n";
  std::string loads = "103,'1',1,1,1,250.0,30.0,0,0,0,0,1,1,0\n";
  std::string shunts;
  std::string generators =
      "101,'1',153.0,73.0,100,-100,1.05,0,100,0,0.3,0,0,1,1,100,318,0,1,1\n"
      "102,'1',100.0,-3.0,100,-100,1.02,0,100,0,0.25,0,0,1,1,100,318,0,1,1\n";
  std::string branches =
      "101,103,'1',0.01,0.12,0.0,250,250,250,0,0,0,0,1,1,0,1,1\n"
      "102,103,'1',0.01,0.12,0.0,250,250,250,0,0,0,0,1,1,0,1,1\n";
  std::string transformers;
  std::map<std::string, std::string> other;
  std::string end = "Q\n";

  static const std::vector<std::string>& tail() {
    static const std::vector<std::string> names = {"area",
                                                   "two-terminal dc line",
                                                   "voltage source converter dc line",
                                                   "impedance correction",
                                                   "multi-terminal dc line",
                                                   "multi-section line",
                                                   "zone",
                                                   "inter-area transfer",
                                                   "owner",
                                                   "FACTS device",
                                                   "switched shunt",
                                                   "GNE device",
                                                   "induction machine"};
    return names;
  }
  [[nodiscard]] std::string text() const {
    std::string t = "0, 100.0, " + std::to_string(version) + header_rest + "\nfirst title\nsecond title\n";
    for (const auto* part : {&buses, &loads, &shunts, &generators, &branches, &transformers})
      t += *part + "0 / END OF DATA\n";
    for (const auto& name : tail()) {
      if (version < 33 && name == "induction machine") continue;
      const auto found = other.find(name);
      t += (found == other.end() ? "" : found->second) + "0 / END OF DATA\n";
    }
    return t + end;
  }
  network::Network read() const {
    const ScratchFile file("case.raw", text());
    return read_raw(file.path);
  }
};

/// Problems thrown by an action; empty if none.
inline std::vector<Problem> problems_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.problems();
  }
  return {};
}
/// Problems as one text, for substring tests.
inline std::string sentences_of(const std::function<void()>& action) {
  std::string all;
  for (const Problem& p : problems_of(action)) all += p.sentence() + "\n";
  return all;
}
/// Places of the remark whose text contains `part`; empty if there is none.
inline std::vector<std::string> places(const network::Network& n, const std::string& part) {
  for (const network::Remark& r : n.remarks)
    if (r.what.find(part) != std::string::npos) return r.places;
  return {};
}
/// Line of `text` (from 1) on which `part` begins.
inline int line_of(const std::string& text, const std::string& part) {
  const auto at = text.find(part);
  return at == std::string::npos
             ? -1
             : 1 + static_cast<int>(
                       std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace swingbank::sim::formats
