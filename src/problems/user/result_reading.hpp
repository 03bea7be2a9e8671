// Reads one number of what a command has left: of a file or of its standard output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <stdexcept>
#include <string>
#include <utility>

namespace armwright {

// Which of the values of a CSV column is the result.
enum class ColumnRow : std::uint8_t { last, first, max, min, mean };

struct ResultReading {
  enum class Kind : std::uint8_t { json, column, regex, exit_code };
  static constexpr const char* kStandardOutput = "stdout";

  Kind kind = Kind::exit_code;
  std::string from = kStandardOutput;  // or a plain file name
  // The JSON pointer ("/results/0/error"), the name or the number of the column, or the regular
  // expression.
  std::string what;
  ColumnRow row = ColumnRow::last;  // of a column
  // The regular expression has one group or more, and the first is the number. Each line is
  // searched for it; the last line that has it counts.
  std::regex pattern;
};

// A result is missing or is no number. The message names the file and what was looked for; it is
// the same whenever the result is missing. `found` completes it for a warning, as in "; it is 'nan'".
class MissingResult : public std::runtime_error {
 public:
  explicit MissingResult(const std::string& what, std::string found = "")
      : std::runtime_error(what), found_(std::move(found)) {}
  const std::string& found() const { return found_; }

 private:
  std::string found_;
};

inline constexpr std::size_t kMostResult_bytes = std::size_t{64} << 20;  // of one file

// What a command has left. Reads each file once.
class CommandResults {
 public:
  // `output` is the command's standard output; nothing if it was too long to be kept.
  CommandResults(const std::filesystem::path& folder, std::optional<std::string> output,
                 int exit_code);
  // Returns the finite number. Throws MissingResult.
  double read(const ResultReading& reading);

 private:
  const std::string& get_text(const std::string& from);
  const nlohmann::json& get_json(const std::string& from);

  std::filesystem::path folder_;
  std::map<std::string, std::string> texts_;
  std::map<std::string, nlohmann::json> parsed_;
  int exit_code_ = 0;
};

}  // namespace armwright
