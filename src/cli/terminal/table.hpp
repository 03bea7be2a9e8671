// Aligned text tables for people. Widths count characters, not bytes.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/terminal.hpp"

namespace armwright {

struct Column {
  std::string title;
  bool right = true;   // right-aligned, as numbers are; words are left-aligned
  bool wraps = false;  // whether a cell may take several lines if the table is too wide
};

constexpr int kUnlimited = 1 << 30;

// Splits the text into lines of at most `width` characters. A longer word gets a line of its own.
std::vector<std::string> wrap_words(const std::string& text, int width);

// Columns and rows of text.
class Table {
 public:
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  void add_row(std::vector<std::string> cells);  // one cell per column
  // Returns a line of titles (no line if all titles are empty) and the rows, each indented by
  // `indent` characters. Columns that wrap are made narrower until the table fits in `width`.
  std::string format(const Style& style, int indent = 0, int width = kUnlimited) const;

 private:
  std::vector<std::size_t> calc_widths(int room) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace armwright
