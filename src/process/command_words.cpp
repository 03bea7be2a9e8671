#include "process/command_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

struct Interpreter {
  std::string_view name;
  std::string_view extension;  // of its scripts
};
// The first row of an extension runs scripts that are named without an interpreter.
constexpr Interpreter kInterpreters[] = {
    {"python3", ".py"}, {"python", ".py"}, {"julia", ".jl"}, {"Rscript", ".R"}, {"bash", ".sh"},
    {"sh", ".sh"},      {"node", ".js"},   {"octave", ".m"}, {"perl", ".pl"},   {"ruby", ".rb"}};

const Interpreter* find_interpreter_of(std::string_view script) {
  const auto found = std::ranges::find_if(kInterpreters, [&](const Interpreter& one) {
    return script.size() > one.extension.size() && script.ends_with(one.extension);
  });
  return found == std::end(kInterpreters) ? nullptr : found;
}

}  // namespace

bool is_interpreter(std::string_view word) {
  return std::ranges::find(kInterpreters, word, &Interpreter::name) != std::end(kInterpreters);
}

std::string suggest_exec(std::string_view text) {
  const std::size_t blank = text.find(' ');
  const std::string_view first = text.substr(0, blank);
  const Interpreter* const script = find_interpreter_of(first);
  if (script != nullptr) {
    const std::string_view plain = text.starts_with("./") ? text.substr(2) : text;
    return fmt::format("exec:{} {}", script->name, plain);
  }
  if (!is_interpreter(first)) {
    return "";
  }
  const auto* const row = std::ranges::find(kInterpreters, first, &Interpreter::name);
  return blank == std::string_view::npos ? fmt::format("exec:{} mine{}", first, row->extension)
                                         : fmt::format("exec:{}", text);
}

std::string describe_missing_exec(std::string_view kind, std::string_view text,
                                  std::string_view flag) {
  return fmt::format(
      "unknown {} '{}'; a program of your own needs exec: before its command, as in {}\"{}\"", kind,
      sanitize(text), flag, sanitize(suggest_exec(text)));
}

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
