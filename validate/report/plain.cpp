// Rendering of documents as Markdown, and of tables as Markdown, CSV and terminal text.
#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

#include "validate/report/document.hpp"
#include "validate/report/figures.hpp"

namespace swingbank::validate::report {

std::string markdown(const Document& document) {
  std::string text = fmt::format("# {}\n\n{}\n\n", document.title, document.subtitle);
  const auto add = [&](const auto& block) {
    using B = std::decay_t<decltype(block)>;
    if constexpr (std::is_same_v<B, Heading>)
      text += fmt::format("{} {}\n\n", std::string(static_cast<std::size_t>(block.level), '#'), block.text);
    else if constexpr (std::is_same_v<B, Table>)
      text += markdown(block) + "\n";
    else if constexpr (std::is_same_v<B, Picture>)
      text += block.file.empty() ? "" : fmt::format("![{}]({})\n\n", block.caption, block.file);
    else if constexpr (std::is_same_v<B, Facts>)
      for (const auto& [name, value] : block.rows)
        text += name == "command"
                    ? ""
                    : fmt::format("- {}: {}\n", name, value);  // the command contains local paths
    else if constexpr (std::is_same_v<B, Paragraph>)
      if (block.in_markdown) text += (block.kind == Paragraph::Kind::note ? "> " : "") + block.text + "\n\n";
  };
  for (const Block& block : document.blocks) std::visit(add, block);
  return text;
}

std::string markdown(const Table& table) {
  const auto clean = [](std::string s) {
    for (std::size_t at = 0; (at = s.find('|', at)) != std::string::npos; at += 2) s.insert(at, "\\");
    return s;
  };
  std::string out = table.caption.empty() ? "" : table.caption + "\n\n";
  out += "|";
  for (const auto& h : table.header) out += " " + clean(h) + " |";
  out += "\n|";
  for (std::size_t i = 0; i < table.header.size(); ++i) out += i == 0 ? " --- |" : " ---: |";
  for (const auto& row : table.rows) {
    out += "\n|";
    for (const auto& cell : row) out += " " + clean(cell.text) + " |";
  }
  return out + "\n";
}

std::string csv(const Table& table) {
  const auto quoted = [](const std::string& s) {
    if (s.find_first_of(",\"\r\n") == std::string::npos) return s;
    std::string r = "\"";
    for (const char c : s) r += c == '"' ? "\"\"" : std::string(1, c);
    return r + "\"";
  };
  std::string out;
  const auto line = [&](const auto& cells, const auto& text) {
    for (std::size_t i = 0; i < cells.size(); ++i) out += (i ? "," : "") + quoted(text(cells[i]));
    out += "\n";
  };
  line(table.header, [](const std::string& s) { return s; });
  for (const auto& row : table.rows) line(row, [](const Cell& c) { return c.text; });
  return out;
}

std::string padded(const Table& table, std::size_t left) {
  std::vector<std::ptrdiff_t> width;
  for (const auto& h : table.header) width.push_back(characters(h));
  for (const auto& row : table.rows)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], characters(row[i].text));
  std::string out;
  const auto line = [&](const auto& row, const auto& text) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string pad(static_cast<std::size_t>(width[i] - characters(text(row[i]))), ' ');
      out += i < left ? text(row[i]) + pad + "  " : pad + text(row[i]) + "  ";
    }
    out.erase(out.find_last_not_of(' ') + 1);
    out += "\n";
  };
  line(table.header, [](const std::string& s) { return s; });
  for (const auto& row : table.rows) line(row, [](const Cell& c) { return c.text; });
  return out;
}

}  // namespace swingbank::validate::report
