#pragma once
// Parser of the MATLAB subset of case files: assignments of numbers, strings, matrices and cell arrays. Used
// only by matpower.cpp.
#include <string>
#include <vector>

#include "base/problem.hpp"

namespace swingbank::sim::formats::matpower {

/// One row of a matrix.
struct Row {
  int line;  ///< line of the file, from 1
  std::vector<long double> values;
};
/// An assignment `name = value`. A number is a matrix of one row and one column; a string has no rows.
struct Assignment {
  std::string name;  ///< field name without the struct: "bus"
  int line;
  enum Kind { matrix, text, cell } kind;
  std::vector<Row> rows;
  std::string words;  ///< value of a string
};
/// Reads every assignment to a field of the case's struct. Any other statement that could change a value
/// (indexed assignment, loop, expression) becomes a problem with file and line. Comments, the function's head
/// and its end are ignored.
std::vector<Assignment> read_assignments(const std::string& text, const std::string& file,
                                         Problems& problems);

}  // namespace swingbank::sim::formats::matpower
