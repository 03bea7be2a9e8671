#include "cli/terminal/table.hpp"

#include <algorithm>
#include <cassert>
#include <string_view>
#include <utility>

#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::size_t kGap = 2;  // between two columns

// Continuation bytes of UTF-8 are no characters.
std::size_t count_characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

}  // namespace

std::vector<std::string> wrap_words(const std::string& text, int width) {
  std::vector<std::string> lines;
  std::string line;
  for (const std::string& word : split(text, ' ')) {
    const bool fits = count_characters(line) + 1 + count_characters(word) <=
                      static_cast<std::size_t>(std::max(0, width));
    if (lines.empty() && line.empty()) {
      line = word;
    } else if (fits) {
      line += ' ' + word;
    } else {
      lines.push_back(std::move(line));
      line = word;
    }
  }
  lines.push_back(std::move(line));
  return lines;
}

void Table::add_row(std::vector<std::string> cells) {
  assert(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

std::vector<std::size_t> Table::calc_widths(int room) const {
  std::vector<std::size_t> widths;
  std::vector<std::size_t> least;  // the smallest width of a column that wraps
  std::size_t total = 0;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    std::size_t width = count_characters(columns_[c].title);
    std::size_t longest_word = width;
    for (const auto& row : rows_) {
      width = std::max(width, count_characters(row[c]));
      for (const std::string& word : split(row[c], ' ')) {
        longest_word = std::max(longest_word, count_characters(word));
      }
    }
    widths.push_back(width);
    least.push_back(columns_[c].wraps ? longest_word : width);
    total += width + (c > 0 ? kGap : 0);
  }
  // The widest column that wraps is made narrower first.
  while (total > static_cast<std::size_t>(room)) {
    std::size_t widest = columns_.size();
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      if (widths[c] > least[c] && (widest == columns_.size() || widths[c] > widths[widest])) {
        widest = c;
      }
    }
    if (widest == columns_.size()) {
      break;
    }
    --widths[widest];
    --total;
  }
  return widths;
}

std::string Table::format(const Style& style, int indent, int width) const {
  const std::vector<std::size_t> widths = calc_widths(std::max(0, width - indent));
  const auto format_line = [&](const auto& get_cell) {
    std::string line(static_cast<std::size_t>(indent), ' ');
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const std::string cell = get_cell(c);
      const std::size_t length = count_characters(cell);
      const std::string padding(widths[c] - std::min(widths[c], length), ' ');
      line += std::string(c > 0 ? kGap : 0, ' ');
      line += columns_[c].right ? padding + cell : cell + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    return line;
  };
  std::string text;
  const bool titled =
      std::ranges::any_of(columns_, [](const Column& column) { return !column.title.empty(); });
  if (titled) {
    text += style.bold(format_line([&](std::size_t c) { return columns_[c].title; })) + '\n';
  }
  for (const auto& row : rows_) {
    std::vector<std::vector<std::string>> cells;
    std::size_t height = 1;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const bool is_wrapped = columns_[c].wraps && count_characters(row[c]) > widths[c];
      cells.push_back(is_wrapped ? wrap_words(row[c], static_cast<int>(widths[c]))
                                 : std::vector<std::string>{row[c]});
      height = std::max(height, cells.back().size());
    }
    for (std::size_t k = 0; k < height; ++k) {
      text += format_line([&](std::size_t c) {
                return k < cells[c].size() ? cells[c][k] : std::string();
              }) +
              '\n';
    }
  }
  return text;
}

}  // namespace armwright
