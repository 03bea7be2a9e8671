#include "process/command_words.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"

namespace armwright {

std::vector<std::string> split_command(std::string_view command, std::string_view kind) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = 0;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    const bool is_last = i + 1 == command.size();
    if (quote == 0 && (c == ' ' || c == '\t' || c == '\n')) {
      in_word = false;
      continue;
    }
    if (!in_word) {
      words.emplace_back();
      in_word = true;
    }
    if (quote != 0 && c == quote) {
      quote = 0;
    } else if (quote == 0 && (c == '\'' || c == '"')) {
      quote = c;
    } else if (c == '\\' && quote == 0 && !is_last) {
      words.back() += command[++i];
    } else if (c == '\\' && quote == '"' && !is_last &&
               std::string_view("\\\"$`").find(command[i + 1]) != std::string_view::npos) {
      words.back() += command[++i];
    } else {
      words.back() += c;
    }
  }
  if (quote != 0) {
    throw Error(ErrorKind::usage, fmt::format("{} 'exec:{}': a quote ({}) is not closed", kind,
                                              sanitize(command), quote));
  }
  if (words.empty() || words.front().empty()) {
    throw Error(ErrorKind::usage,
                fmt::format("{} 'exec:' names no program; write 'exec:PROGRAM ARGUMENTS', as in "
                            "'exec:python3 mine.py'",
                            kind));
  }
  return words;
}

std::vector<std::string> list_program_files(std::string_view command) {
  std::vector<std::string> files = split_command(command, "the command");
  std::erase_if(files, [](const std::string& word) {
    std::error_code ignored;
    return !std::filesystem::is_regular_file(word, ignored);
  });
  return files;
}

std::string calc_program_hash(const std::filesystem::path& file) {
  constexpr std::size_t kLargestFile_bytes = std::size_t{1} << 30;
  return calc_sha256_hex(read_file(file, kLargestFile_bytes));
}

}  // namespace armwright
