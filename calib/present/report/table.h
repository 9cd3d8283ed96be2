#pragma once

#include <string>
#include <vector>

#include "calib/present/report/verdict.h"

namespace rgbdt {

struct Cell {
  std::string text;
  Grade mark = Grade::kNone;  ///< what the cell says of the result
};

using Row = std::vector<Cell>;

/// For a person: the page and the plain HTML page show the same one.
struct Table {
  std::string title;
  std::vector<std::string> notes;  ///< sentences between title and table
  std::vector<std::string> head;   ///< of each column; the first column names the rows
  std::vector<Row> rows;

  bool empty() const { return rows.empty() && notes.empty(); }
};

}  // namespace rgbdt
