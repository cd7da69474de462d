#pragma once
// Snapshot of an experiment: its file and every file that it names, copied into a folder, so that later edits
// of the originals do not affect waiting jobs.
#include <filesystem>
#include <string>

#include "base/config.hpp"
#include "base/durable.hpp"
#include "base/problem.hpp"
#include "mpi/draw/card.hpp"

namespace swingbank::jobs {

/// Copies an experiment into `folder`. Returns the path of the copy. A dataset generated from the copy equals
/// that of the original, because the config hash covers values and contents, not names. Throws InputError if
/// a dataset config is invalid, or a file cannot be read or written.
inline std::filesystem::path keep_experiment(const std::filesystem::path& file,
                                             const std::filesystem::path& folder) {
  std::string text = read_text(file);
  Config c(file);
  std::string first;  // both keys may name the same file
  for (const char* key : {"dataset", "training_dataset"}) {
    if (!c.has(key)) continue;
    const auto written = c.require<std::string>(key);
    if (written == first) continue;
    first = written;
    const mpi::draw::DatasetConfig config = mpi::draw::read_dataset_config(c.file(key));
    const auto kept = mpi::draw::unpack(mpi::draw::card_of(config, {}, {}), folder / key);
    if (!mpi::draw::replace_name(text, written, (std::filesystem::path(key) / kept.filename()).string()))
      throw InputError({"a name that cannot be replaced", file.string(),
                        "the file writes the name '" + written + "' with escape sequences",
                        "write the name in quotes, without escape sequences"});
  }
  make_folder(folder);
  write_text(folder / file.filename(), text);
  return folder / file.filename();
}

}  // namespace swingbank::jobs
