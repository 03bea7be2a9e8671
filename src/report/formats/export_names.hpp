// Names as other programs can bear them: any UTF-8 text as the name of a file or of a column.
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace armwright {

// One component of a path on every system: letters, digits, '_', '-' and '.', beginning with none
// of the last two; '_' stands for every other character. At most 80 long, never empty.
std::string escape_file_name(std::string_view name);

// A column of a table whose fields are separated by blanks: letters, digits and '_', beginning with
// a letter.
std::string escape_column_name(std::string_view name);

// Names that are told apart also where case does not count: one that is taken gets "-2", "-3", ...
class UniqueNames {
 public:
  explicit UniqueNames(char separator = '-') : separator_(separator) {}
  std::string add(const std::string& name);

 private:
  char separator_;
  std::set<std::string> taken_;  // in small letters
};

// For each of the names one of a file; different for different names.
std::map<std::string, std::string> make_file_names(std::span<const std::string> names);

}  // namespace armwright
