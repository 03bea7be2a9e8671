// Aligned text tables for people. Widths count characters, not bytes.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal.hpp"

namespace armwright {

struct Column {
  std::string title;
  bool right = true;  // numbers to the right, words to the left
};

class Table {
 public:
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  void add_row(std::vector<std::string> cells);  // one a column
  // A line of titles (none if all are empty) and one a row, each indented by `indent`.
  std::string format(const Style& style, int indent = 0) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace armwright
