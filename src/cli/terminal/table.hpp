// Aligned text tables for people. Widths count characters, not bytes.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/terminal.hpp"

namespace armwright {

struct Column {
  std::string title;
  bool right = true;   // numbers to the right, words to the left
  bool wraps = false;  // several lines a cell where the table would be too wide otherwise
};

constexpr int kUnlimited = 1 << 30;

// The words in lines of at most `width` characters; a longer word has a line of its own.
std::vector<std::string> wrap_words(const std::string& text, int width);

class Table {
 public:
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  void add_row(std::vector<std::string> cells);  // one a column
  // A line of titles (none if all are empty) and one a row, each indented by `indent`. Columns that
  // wrap share what is left of `width`.
  std::string format(const Style& style, int indent = 0, int width = kUnlimited) const;

 private:
  std::vector<std::size_t> calc_widths(int room) const;

  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace armwright
