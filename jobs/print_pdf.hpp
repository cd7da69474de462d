#pragma once
// PDF output (--pdf): an HTML page printed by headless Chromium, if it is installed.
#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>

#include "base/durable.hpp"
#include "base/own_command.hpp"
#include "base/problem.hpp"

namespace swingbank::jobs {

/// Returns the path of Chromium or Google Chrome; empty if PATH has none.
inline std::filesystem::path browser() {
  const char* path = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"}) {
    std::istringstream folders(path == nullptr ? "" : path);
    for (std::string folder; std::getline(folders, folder, ':');)
      if (const auto program = std::filesystem::path(folder) / name; ::access(program.c_str(), X_OK) == 0)
        return program;
  }
  return {};
}

/// Adds a problem if a PDF cannot be written. Call it before the work.
inline void browser_for(const std::string& pdf, Problems& problems) {
  if (browser().empty())
    problems.add("no Chromium", "--pdf", "Chromium prints the page, and PATH does not contain it",
                 "install the package chromium, or leave --pdf out and print report.html from any browser");
  const auto folder = std::filesystem::absolute(pdf).parent_path();
  if (!std::filesystem::is_directory(folder))
    problems.add("no folder for " + pdf, "--pdf", "there is no " + folder.string(), "create this folder");
  else if (std::filesystem::is_directory(pdf))
    problems.add("a folder instead of a file", "--pdf", pdf + " is a folder", "give a file's name");
}

/// Returns the URL "file:///..." with all characters except letters, digits and "/-._~" as %XX.
inline std::string file_url(const std::filesystem::path& file) {
  std::string url = "file://";
  for (const char c : std::filesystem::absolute(file).string())
    url += std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                   std::string_view("/-._~").find(c) != std::string_view::npos
               ? std::string(1, c)
               : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return url;
}

/// Prints the page to a PDF file, written atomically. Throws InputError if the browser fails.
inline void print_pdf(const std::filesystem::path& page, const std::filesystem::path& pdf) {
  namespace fs = std::filesystem;
  const Scratch scratch;
  const fs::path made = scratch.folder() / "page.pdf";
  std::vector<std::string> words = {"--headless",
                                    "--disable-gpu",
                                    "--disable-dev-shm-usage",
                                    "--no-first-run",
                                    "--no-pdf-header-footer",
                                    "--user-data-dir=" + (scratch.folder() / "profile").string(),
                                    "--virtual-time-budget=10000",
                                    "--print-to-pdf=" + made.string(),
                                    file_url(page)};
  if (::geteuid() == 0) words.insert(words.begin(), "--no-sandbox");
  const int code = run_own(browser(), words, false, true);
  if (code == 0 && fs::exists(made)) return write_text(pdf, read_text(made));
  throw InputError({"the page was not printed", pdf.string(),
                    fmt::format("Chromium ended with exit code {}", code),
                    "print " + page.string() + " from a browser; all other files are written"});
}

}  // namespace swingbank::jobs
