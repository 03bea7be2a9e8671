#include "cli/table.hpp"

#include <algorithm>
#include <cassert>
#include <string_view>

namespace armwright {
namespace {

// Continuation bytes of UTF-8 take no room.
std::size_t count_characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

}  // namespace

void Table::add_row(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::format(const Style& style, int indent) const {
  std::vector<std::size_t> widths;
  bool titled = false;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    std::size_t width = count_characters(columns_[c].title);
    for (const auto& row : rows_) {
      width = std::max(width, count_characters(row[c]));
    }
    widths.push_back(width);
    titled = titled || !columns_[c].title.empty();
  }
  const auto format_line = [&](const auto& get_cell) {
    std::string line(static_cast<std::size_t>(indent), ' ');
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const std::string& cell = get_cell(c);
      const std::string padding(widths[c] - count_characters(cell), ' ');
      line += (c > 0 ? "  " : "") + (columns_[c].right ? padding + cell : cell + padding);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    return line;
  };
  std::string text;
  if (titled) {
    text += style.bold(format_line([&](std::size_t c) -> const std::string& {
      return columns_[c].title;
    })) + '\n';
  }
  for (const auto& row : rows_) {
    text += format_line([&](std::size_t c) -> const std::string& { return row[c]; }) + '\n';
  }
  return text;
}

}  // namespace armwright
