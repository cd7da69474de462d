#pragma once
// The part of the MATLAB language that case files are written in: assignments of numbers, texts, matrices and
// cell arrays. Used by matpower.cpp only.
#include <string>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::sim::formats::matpower {

struct Row {
  int line;  ///< in the file, from 1
  std::vector<long double> values;
};
/// `name = value`: a number is a matrix of one row and one column, texts have no rows.
struct Assignment {
  std::string name;  ///< without the struct before the dot: "bus"
  int line;
  enum Kind { matrix, text, cell } kind;
  std::vector<Row> rows;
  std::string words;  ///< of a text
};
/// Reads every assignment to a field of the case's struct. Everything else that could change a value (indexed
/// assignments, loops, expressions) goes to `problems` with file and line; comments, the function's head and
/// its end are passed over.
std::vector<Assignment> read_assignments(const std::string& text, const std::string& file,
                                         Problems& problems);

}  // namespace swingbank::sim::formats::matpower
