#include <algorithm>
#include <cctype>

#include "sim/network/psse.hpp"
#include "sim/network/psse_text.hpp"

namespace swingbank::sim {
namespace {

void finish(const psse::Record& record, const std::string& file, Problems& problems,
            std::vector<DyrRecord>& out) {
  psse::Fields fields(record, file, problems);
  DyrRecord dyr{fields.integer(0, "bus number"), fields.text(1, ""), fields.text(2, ""), {}, record.line};
  if (fields.size() < 3) {
    problems.add("incomplete record", fields.where(), "a record is: bus number, 'MODEL', id, parameters, /",
                 "complete the record or remove it");
    return;
  }
  std::ranges::transform(dyr.model, dyr.model.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (std::size_t i = 3; i < fields.size(); ++i)
    dyr.values.push_back(
        static_cast<double>(fields.number(i, (dyr.model + " parameter " + std::to_string(i - 2)).c_str())));
  out.push_back(std::move(dyr));
}

}  // namespace

std::vector<DyrRecord> read_dyr(const std::filesystem::path& file) {
  const auto lines = psse::read_lines(file);
  const std::string name = file.string();
  Problems problems;
  std::vector<DyrRecord> out;
  psse::Record open;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    auto piece = psse::split(lines[i], static_cast<int>(i) + 1, name, problems);
    if (open.fields.empty()) open.line = piece.line;
    open.fields.insert(open.fields.end(), piece.fields.begin(), piece.fields.end());
    if (!piece.ended || open.fields.empty()) continue;
    finish(open, name, problems, out);
    open.fields.clear();
  }
  if (!open.fields.empty())
    problems.add("a record has no end", name + ":" + std::to_string(open.line),
                 "records end with '/'; the file may be truncated",
                 "end the record with '/' or restore the file");
  problems.raise();
  return out;
}

}  // namespace swingbank::sim
