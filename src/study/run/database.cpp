// Writes a run's evaluations into the SQLite file results.sqlite.

#include <fmt/format.h>
#include <sqlite3.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "study/run/derived_files.hpp"
#include "study/run/run_observer.hpp"

namespace armwright {
namespace {

constexpr const char* kSchema = R"(
  CREATE TABLE variable(position INTEGER PRIMARY KEY, name TEXT, unit TEXT, lower REAL, upper REAL, start REAL);
  CREATE TABLE metric(position INTEGER PRIMARY KEY, name TEXT, unit TEXT);
  CREATE TABLE evaluation(role TEXT, number INTEGER, generation INTEGER, status TEXT, reason TEXT, clipped INTEGER,
                          set_name TEXT, first_case INTEGER, cases INTEGER, objective REAL, x TEXT, metrics TEXT,
                          PRIMARY KEY(role, number));
  CREATE TABLE case_error(role TEXT, number INTEGER, case_number INTEGER, error REAL,
                          PRIMARY KEY(role, number, case_number)) WITHOUT ROWID;
)";
constexpr const char* kDiscreteSchema = R"(
  CREATE TABLE discrete_variable(position INTEGER PRIMARY KEY, type TEXT, choices TEXT);
  CREATE TABLE proposal(number INTEGER PRIMARY KEY, x TEXT);
)";

// An existing file that SQLite fills.
class Database {
 public:
  // SQLite takes a path, not an open folder. It must lead to the file without links, so that
  // SQLite can refuse every link. `file` is the name for messages.
  Database(const std::filesystem::path& path, std::filesystem::path file) : file_(std::move(file)) {
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(path.c_str(), &handle,
                                     SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOFOLLOW, nullptr);
    handle_.reset(handle);
    check(code);
  }

  void execute(const char* sql) {
    check(sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr));
  }

  void check(int code) const {
    if (code != SQLITE_OK && code != SQLITE_DONE && code != SQLITE_ROW) {
      // With other codes, the system's error number is that of an earlier call.
      const bool has_reason = (code & 0xff) == SQLITE_IOERR || (code & 0xff) == SQLITE_FULL;
      const int reason = has_reason ? sqlite3_system_errno(handle_.get()) : 0;
      throw Error(ErrorKind::io,
                  fmt::format("{}: cannot write it: {}", file_.string(),
                              reason != 0 ? std::strerror(reason) : sqlite3_errmsg(handle_.get())));
    }
  }

  void close() { check(sqlite3_close(handle_.release())); }
  sqlite3* get() const { return handle_.get(); }

 private:
  struct Closer {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  std::filesystem::path file_;
  std::unique_ptr<sqlite3, Closer> handle_;
};

// A prepared INSERT statement, which is filled column by column.
class Insert {
 public:
  Insert(Database& database, const char* sql) : database_(database) {
    sqlite3_stmt* statement = nullptr;
    database.check(sqlite3_prepare_v2(database.get(), sql, -1, &statement, nullptr));
    statement_.reset(statement);
  }

  Insert& operator<<(const std::string& text) {
    database_.check(sqlite3_bind_text(statement_.get(), ++column_, text.data(),
                                      static_cast<int>(text.size()), SQLITE_TRANSIENT));
    return *this;
  }
  Insert& operator<<(std::uint64_t number) {
    database_.check(
        sqlite3_bind_int64(statement_.get(), ++column_, static_cast<sqlite3_int64>(number)));
    return *this;
  }
  Insert& operator<<(double number) {  // NaN becomes NULL
    database_.check(std::isnan(number) ? sqlite3_bind_null(statement_.get(), ++column_)
                                       : sqlite3_bind_double(statement_.get(), ++column_, number));
    return *this;
  }
  void run() {
    database_.check(sqlite3_step(statement_.get()));
    database_.check(sqlite3_reset(statement_.get()));
    column_ = 0;
  }

 private:
  struct Finalizer {
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
  int column_ = 0;
};

template <class Records>
void insert_records(Database& database, const ProblemDescription& problem, const Records& records) {
  Insert evaluation(database, "INSERT INTO evaluation VALUES (?,?,?,?,?,?,?,?,?,?,?,?)");
  Insert case_error(database, "INSERT INTO case_error VALUES (?,?,?,?)");
  for (const EvaluationRecord& record : records) {
    const Evaluation& result = record.evaluation;
    const std::string role = to_string(record.cases.role);
    const auto& numbers = record.cases.numbers;
    evaluation << role << record.index << record.generation << std::string(to_string(result.status))
               << result.reason << std::uint64_t{record.clipped} << record.cases.set
               << (numbers.empty() ? std::uint64_t{0} : numbers.front())
               << std::uint64_t{numbers.size()}
               << (result.objectives.empty() ? std::nan("")
                                             : calc_scalar(problem, result.objectives))
               << nlohmann::json(record.x).dump() << nlohmann::json(result.metrics).dump();
    evaluation.run();
    for (std::size_t i = 0; i < result.case_errors.size() && i < numbers.size(); ++i) {
      case_error << role << record.index << numbers[i] << result.case_errors[i];
      case_error.run();
    }
  }
}

void insert_discrete(Database& database, const ProblemDescription& problem,
                     const RecordedEvaluations& training) {
  database.execute(kDiscreteSchema);
  Insert discrete(database, "INSERT INTO discrete_variable VALUES (?,?,?)");
  for (std::size_t i = 0; i < problem.variables.size(); ++i) {
    const DecisionVariable& variable = problem.variables[i];
    if (variable.type != VariableType::real) {
      discrete << std::uint64_t{i} << std::string(to_string(variable.type))
               << nlohmann::json(variable.choices).dump();
      discrete.run();
    }
  }
  Insert proposal(database, "INSERT INTO proposal VALUES (?,?)");
  for (const EvaluationRecord& record : training) {
    if (!record.proposed.empty()) {
      proposal << record.index << nlohmann::json(record.proposed).dump();
      proposal.run();
    }
  }
}

void fill_database(Database& database, const ProblemDescription& problem,
                   const JournalContent& journal) {
  // The whole file is synced at the end; no other process uses it before that.
  database.execute("PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; BEGIN");
  database.execute(kSchema);
  {
    Insert variable(database, "INSERT INTO variable VALUES (?,?,?,?,?,?)");
    for (std::size_t i = 0; i < problem.variables.size(); ++i) {
      const DecisionVariable& v = problem.variables[i];
      variable << std::uint64_t{i} << v.name << v.unit << v.lower << v.upper << v.start;
      variable.run();
    }
    Insert metric(database, "INSERT INTO metric VALUES (?,?,?)");
    for (std::size_t i = 0; i < problem.metrics.size(); ++i) {
      metric << std::uint64_t{i} << problem.metrics[i].name << problem.metrics[i].unit;
      metric.run();
    }
    insert_records(database, problem, journal.training);
    insert_records(database, problem, journal.judgements);
    if (has_discrete(problem.variables)) {
      insert_discrete(database, problem, journal.training);
    }
  }
  database.execute("COMMIT");
  database.close();
}

// Returns the path of an open file, without links.
std::filesystem::path find_place(const FileDescriptor& file, const std::filesystem::path& name) {
  std::error_code error;
  auto place = std::filesystem::read_symlink(fmt::format("/proc/self/fd/{}", file.get()), error);
  if (error) {
    fail_io(name, "find its place", error.value());
  }
  return place;
}

}  // namespace

void write_database(const Folder& folder, const std::string& name,
                    const ProblemDescription& problem, const JournalContent& journal) {
  const std::string temporary = name + ".new";
  FileDescriptor file = folder.create(temporary);
  try {
    Database database(find_place(file, folder.path() / temporary), folder.path() / temporary);
    fill_database(database, problem, journal);
    folder.put_in_place(file, temporary, name);
  } catch (...) {
    folder.remove(temporary);
    throw;
  }
}

}  // namespace armwright
