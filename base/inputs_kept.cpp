#include "base/inputs_kept.hpp"

#include <algorithm>
#include <mutex>
#include <system_error>

#include "base/problem.hpp"

namespace swingbank {

namespace fs = std::filesystem;

namespace {

struct Inputs {
  std::mutex lock;
  bool kept = false;
  std::vector<fs::path> files;
};
Inputs& inputs() {
  static Inputs all;
  return all;
}

/// Returns the absolute path with links, "." and ".." resolved. The file need not exist yet.
fs::path resolved(const fs::path& file) {
  std::error_code error;
  fs::path found = fs::weakly_canonical(fs::absolute(file, error), error);
  return error ? fs::absolute(file, error).lexically_normal() : found.lexically_normal();
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return resolved(a) == resolved(b) || fs::equivalent(a, b, error);
}

}  // namespace

void keep_inputs(bool on) {
  const std::lock_guard guard(inputs().lock);
  inputs().kept = on;
  inputs().files.clear();
}

void note_input(const fs::path& file) {
  const std::lock_guard guard(inputs().lock);
  if (!inputs().kept) return;
  std::error_code error;
  inputs().files.push_back(fs::absolute(file, error));
}

void require_inputs_kept(const std::vector<Output>& outputs) {
  const std::lock_guard guard(inputs().lock);
  if (!inputs().kept) return;
  Problems problems;
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    const auto is_output = [&](const auto& other) { return same_file(other, output->file); };
    const auto input = std::ranges::find_if(inputs().files, is_output);
    const auto other =
        std::ranges::find_if(outputs.begin(), output, is_output, [](const Output& o) { return o.file; });
    if (input != inputs().files.end())
      problems.add("output " + output->file.string() + " is an input", output->where,
                   "the command has read it as " + input->string() + " and would replace it",
                   "give another name or folder for the output");
    else if (other != output)
      problems.add("output " + output->file.string() + " is named twice", output->where,
                   "it is also written for " + other->where, "give each output its own name");
  }
  problems.raise();
}

}  // namespace swingbank
