#pragma once
// A page in headless Chromium, at the width of a mobile phone.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/json.hpp"

namespace swingbank::validate::test {

struct Shown {
  std::string complaints;  ///< console output of the page's scripts and of the browser
  nlohmann::json result;   ///< value of document.body.dataset.result after the added script
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Renders the page with `script` added at its end. Throws if the browser does not run or the script sets no
/// result.
inline Shown show(const std::string& html, const std::string& script) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / fmt::format("swingbank_browser_{}", ::getpid());
  fs::create_directories(folder);
  std::ofstream(folder / "page.html") << html << script;
  const std::string command = fmt::format(
      "cd '{}' && HOME=$PWD timeout 100 chromium --headless --no-sandbox --disable-gpu "
      "--disable-dev-shm-usage "
      "--no-first-run --user-data-dir=\"$PWD/profile\" --window-size=390,844 --enable-logging=stderr --v=0 "
      "--virtual-time-budget=5000 --dump-dom \"file://$PWD/page.html\" >dom 2>log",
      folder.string());
  const int code = std::system(command.c_str());
  Shown shown;
  const std::string dom = text_of(folder / "dom"), log = text_of(folder / "log");
  fs::remove_all(folder);
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);)
    if (line.find("CONSOLE") != std::string::npos) shown.complaints += line + "\n";
  const std::string mark = "data-result=\"";
  const auto begin = dom.find(mark);
  if (code != 0 || begin == std::string::npos)
    throw std::runtime_error(fmt::format("chromium: exit code {}, no result; it said: {}", code, log));
  std::string result =
      dom.substr(begin + mark.size(), dom.find('"', begin + mark.size()) - begin - mark.size());
  const auto replace = [&](const std::string& entity, const std::string& by) {
    for (std::size_t at = 0; (at = result.find(entity, at)) != std::string::npos; at += by.size())
      result.replace(at, entity.size(), by);
  };
  replace("&quot;", "\"");
  replace("&lt;", "<");
  replace("&gt;", ">");
  replace("&amp;", "&");
  shown.result = nlohmann::json::parse(result);
  return shown;
}

}  // namespace swingbank::validate::test
