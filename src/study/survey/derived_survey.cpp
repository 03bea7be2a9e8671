#include "study/survey/derived_survey.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/config.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "problems/config/design_file.hpp"
#include "problems/config/values_file.hpp"

namespace armwright {
namespace {

constexpr std::size_t kLimit_bytes = std::size_t{1} << 30;

// Reads rows as RFC 4180 defines them: a quoted field may hold commas, line ends and doubled
// quotes.
class CsvRows {
 public:
  explicit CsvRows(std::string_view text) : rest_(text) {}

  bool at_end() const { return rest_.empty(); }
  // Returns the number of fields of the next row; 0 if the row is not complete.
  std::size_t next() {
    std::size_t fields = 1;
    bool quoted = false;
    for (std::size_t i = 0; i < rest_.size(); ++i) {
      const char c = rest_[i];
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        ++fields;
      } else if (c == '\n' && !quoted) {
        rest_.remove_prefix(i + 1);
        return fields;
      } else if (c == '\0') {
        return 0;
      }
    }
    return 0;
  }

 private:
  std::string_view rest_;
};

struct Closer {
  void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

// Returns the rows of a query as texts. Sets `fault` if the query fails.
std::vector<std::vector<std::string>> query(sqlite3* database, const char* sql,
                                            std::string& fault) {
  sqlite3_stmt* raw = nullptr;
  int code = sqlite3_prepare_v2(database, sql, -1, &raw, nullptr);
  const std::unique_ptr<sqlite3_stmt, Closer> statement(raw);
  std::vector<std::vector<std::string>> rows;
  while (code == SQLITE_OK || code == SQLITE_ROW) {
    code = sqlite3_step(statement.get());
    if (code == SQLITE_ROW) {
      auto& row = rows.emplace_back();
      for (int c = 0; c < sqlite3_column_count(statement.get()); ++c) {
        const auto* text = sqlite3_column_text(statement.get(), c);
        row.emplace_back(text != nullptr ? reinterpret_cast<const char*>(text) : "");
      }
    }
  }
  if (code != SQLITE_DONE) {
    fault = sanitize(sqlite3_errmsg(database));
  }
  return rows;
}

std::uint64_t count_rows(const std::vector<std::vector<std::string>>& rows, const char* role) {
  for (const auto& row : rows) {
    if (row[0] == role) {
      return static_cast<std::uint64_t>(parse_integer(row[1]).value_or(0));
    }
  }
  return 0;
}

}  // namespace

std::string find_csv_fault(const std::filesystem::path& file, std::optional<std::uint64_t> last) {
  const std::string text = read_file(file, kLimit_bytes);
  CsvRows rows(text);
  const std::size_t titles = rows.next();
  if (titles == 0) {
    return "its first line is not a line of titles";
  }
  for (std::size_t line = 2; !rows.at_end(); ++line) {
    const std::size_t fields = rows.next();
    if (fields == 0) {
      return fmt::format("row {} is cut short or holds no text", line);
    }
    if (fields != titles) {
      return fmt::format("row {} has {} fields, and the titles are {}", line, fields, titles);
    }
  }
  if (last) {
    const std::string_view rest = std::string_view(text).substr(0, text.size() - 1);
    const std::string_view row = rest.substr(rest.rfind('\n') + 1);
    if (row.substr(0, row.find(',')) != std::to_string(*last)) {
      return fmt::format("its last row is not that of evaluation {}: rows are missing", *last);
    }
  }
  return "";
}

std::string find_json_fault(const std::filesystem::path& file) {
  const std::string text = read_file(file, kLimit_bytes);
  try {
    // Checks the syntax without building a tree, which may need much memory.
    if (nlohmann::json::accept(text)) {
      return "";
    }
    [[maybe_unused]] const auto parsed = nlohmann::json::parse(text);  // throws with the position
  } catch (const nlohmann::json::exception& error) {
    return fmt::format("it is not JSON ({})", describe_json_error(error.what()));
  }
  return "it is not JSON";
}

namespace {

std::string catch_fault(const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::io) {
      throw;
    }
    return sanitize(error.what());
  }
  return "";
}

}  // namespace

std::string find_toml_fault(const std::filesystem::path& file) {
  return catch_fault([&] { ConfigTable::load(file); });
}

std::string find_design_fault(const std::filesystem::path& file) {
  // An absolute path cannot be mistaken for the name of a shipped design.
  return catch_fault([&] { load_design(std::filesystem::absolute(file).string()); });
}

std::string find_values_fault(const std::filesystem::path& file) {
  return catch_fault([&] { load_values(file); });
}

std::string find_database_fault(const std::filesystem::path& file, const RunResult& result) {
  sqlite3* handle = nullptr;
  // Opened read-only, so SQLite repairs nothing and creates no file beside it.
  const int code = sqlite3_open_v2(file.c_str(), &handle, SQLITE_OPEN_READONLY, nullptr);
  const std::unique_ptr<sqlite3, Closer> database(handle);
  if (code != SQLITE_OK) {
    return fmt::format("SQLite cannot open it: {}", sanitize(sqlite3_errstr(code)));
  }
  std::string fault;
  const auto verdict = query(database.get(), "PRAGMA integrity_check(3)", fault);
  if (!fault.empty()) {
    return fmt::format("SQLite cannot read it: {}", fault);
  }
  if (verdict.size() != 1 || verdict[0][0] != "ok") {
    return fmt::format("SQLite finds damage in it: {}",
                       verdict.empty() ? "no answer" : sanitize(verdict[0][0]));
  }
  const auto counts =
      query(database.get(), "SELECT role, COUNT(*) FROM evaluation GROUP BY role", fault);
  if (!fault.empty()) {
    return fmt::format("SQLite cannot read it: {}", fault);
  }
  const struct {
    const char* role;
    std::uint64_t wanted;
  } expected[] = {{"training", result.counts.evaluations},
                  {"validation", result.judged.size()},
                  {"test", result.winner ? std::uint64_t{1} : 0}};
  for (const auto& [role, wanted] : expected) {
    const std::uint64_t found = count_rows(counts, role);
    if (found != wanted) {
      return fmt::format("it holds {} rows for {}; {} are recorded", found, role, wanted);
    }
  }
  return "";
}

}  // namespace armwright
