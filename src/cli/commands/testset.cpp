// armwright testset: writes test cases to files and reads them from files.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/text.hpp"
#include "cli/commands/commands.hpp"
#include "cli/terminal/arguments.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/session.hpp"
#include "cli/terminal/terminal.hpp"
#include "cli/views/design_and_problem.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright {
namespace {

constexpr const char* kTestsetExamples = R"(Examples:
  armwright testset export test/2 --cases 500 --out test-2.json
  armwright testset import mine.csv --out mine.json
  armwright testset hash test/2 --cases 500
  armwright evaluate table-a5 --problem q1-complex --test-cases mine.json

Terms: a test case is a start point and the points that the arm's tip has to reach after it. A generated set is defined
by its name only: case N of test/2 is the same on every machine. The names are train/ID, validation/ID and test/ID.)";

constexpr const char* kTestsetExportExamples = R"(Examples:
  armwright testset export test/2 --cases 500 --out test-2.json
  armwright testset export train/1 --cases 3 --format csv
  armwright testset export test/1 --cases 100 --problem mine.toml    # in that problem's workspace)";

constexpr const char* kTestsetImportExamples = R"(Examples:
  armwright testset import mine.csv                # check the file; print the number of cases and their hash
  armwright testset import mine.csv --out mine.json
  armwright testset import mine.json --out - --format csv)";

constexpr const char* kTestsetHashExamples = R"(Examples:
  armwright testset hash test/2 --cases 500
  armwright testset hash mine.json

The hash is SHA-256 over the coordinates. Equal cases have equal hashes, whatever their file or name is.)";

struct TestsetOptions {
  std::string name;  // of a set, or of a file
  std::string cases;
  std::string format;
  std::string out;
  std::string problem;
};

void check_set_name(const std::string& name) {
  const auto parts = split(name, '/');
  const std::vector<std::string> kinds = {"train", "validation", "test"};
  if (parts.size() != 2 || parts[1].empty() ||
      std::find(kinds.begin(), kinds.end(), parts[0]) == kinds.end()) {
    throw Error(ErrorKind::usage,
                fmt::format("'{}' is no test set; the name of a generated set is train/ID, "
                            "validation/ID or test/ID, as in test/2",
                            sanitize(name)));
  }
}

std::vector<TestCase> make_cases(const TestsetOptions& options) {
  check_set_name(options.name);
  const auto count = parse_count("--cases", options.cases, 1, kMostCases);
  const WorkspaceSphere sphere =
      options.problem.empty() ? WorkspaceSphere{}
                              : require_tracking(load_problem(options.problem)).config().workspace;
  const TestSet set = TestSet::make_generated(options.name, sphere);
  std::vector<TestCase> cases;
  for (std::int64_t i = 0; i < count; ++i) {
    cases.push_back(set.make_case(static_cast<std::uint64_t>(i)));
  }
  return cases;
}

std::vector<TestCase> load_cases(const std::string& file) {
  const TestSet set = TestSet::load(file);
  std::vector<TestCase> cases;
  for (std::uint64_t i = 0; i < *set.size(); ++i) {
    cases.push_back(set.make_case(i));
  }
  return cases;
}

std::string format_case_file(const std::vector<TestCase>& cases, const TestsetOptions& options) {
  const std::vector<std::string> formats = {"json", "csv"};
  std::string format = options.format;
  if (format.empty()) {
    format = std::filesystem::path(options.out).extension() == ".csv" ? "csv" : "json";
  }
  if (std::find(formats.begin(), formats.end(), format) == formats.end()) {
    throw Error(ErrorKind::usage, describe_unknown("--format", format, formats));
  }
  return format == "csv" ? to_csv(cases) : to_json(cases);
}

std::string describe_cases(const std::vector<TestCase>& cases, const std::string& name) {
  return fmt::format("{}  {}  {}\n", calc_content_hash(cases), format_count(cases.size(), "case"),
                     sanitize(name));
}

int run_export(const TestsetOptions& options) {
  const auto cases = make_cases(options);
  const std::string text = format_case_file(cases, options);
  write_output(options.out.empty() ? "-" : options.out, text);
  return exit_code::kDone;
}

int run_import(const TestsetOptions& options) {
  if (options.out.empty() && !options.format.empty()) {
    throw Error(ErrorKind::usage,
                "--format is the format of the file that --out names; give --out FILE, too");
  }
  const auto cases = load_cases(options.name);
  const std::string summary = describe_cases(cases, options.name);
  if (!options.out.empty()) {
    write_output(options.out, format_case_file(cases, options));
  }
  if (options.out == "-") {
    write_stderr(summary);
  } else {
    write_stdout(summary);
  }
  return exit_code::kDone;
}

int run_hash(const TestsetOptions& options) {
  const bool a_file = regular_file_exists(options.name);
  if (a_file && !options.cases.empty()) {
    throw Error(ErrorKind::usage,
                "--cases works with generated sets only; a file is hashed as a whole");
  }
  TestsetOptions with_count = options;
  if (with_count.cases.empty()) {
    with_count.cases = fmt::format("{}", CaseSets{}.test_cases);
  }
  write_stdout(
      describe_cases(a_file ? load_cases(options.name) : make_cases(with_count), options.name));
  return exit_code::kDone;
}

void add_format(CLI::App& command, TestsetOptions& options, const char* out_help) {
  command
      .add_option("--format", options.format,
                  "json or csv (default: csv for a file named *.csv, otherwise json)")
      ->type_name("FORMAT");
  command.add_option("--out", options.out, out_help)->type_name("FILE");
}

}  // namespace

void add_testset(CLI::App& app, Session& session) {
  auto options = std::make_shared<TestsetOptions>();
  CLI::App* command = add_command(app, session, "testset",
                                  "Write, read and compare sets of test cases", kTestsetExamples);
  command->require_subcommand(1);

  CLI::App* exporting = add_command(*command, session, "export",
                                    "Write the cases of a generated set", kTestsetExportExamples);
  exporting->add_option("NAME", options->name, "The set: train/ID, validation/ID or test/ID")
      ->required();
  exporting->add_option("--cases", options->cases, "The first N cases")->type_name("N")->required();
  add_format(*exporting, *options, "The file (default: standard output)");
  exporting
      ->add_option("--problem,-p", options->problem,
                   "Generate the cases in this problem's workspace (default: the thesis's sphere)")
      ->type_name("PROBLEM");
  exporting->callback(
      [options, &session] { session.action = [options] { return run_export(*options); }; });

  CLI::App* importing = add_command(
      *command, session, "import", "Check a file of cases, and convert it", kTestsetImportExamples);
  importing->add_option("FILE", options->name, "JSON or CSV")->required();
  add_format(*importing, *options, "Write the cases to this file; - is standard output");
  importing->callback(
      [options, &session] { session.action = [options] { return run_import(*options); }; });

  CLI::App* hashing =
      add_command(*command, session, "hash", "Hash the cases of a generated set or a file",
                  kTestsetHashExamples);
  hashing->add_option("NAME", options->name, "The set, or a file")->required();
  hashing
      ->add_option("--cases", options->cases, "The first N cases of a generated set (default: 500)")
      ->type_name("N");
  hashing->callback(
      [options, &session] { session.action = [options] { return run_hash(*options); }; });
}

}  // namespace armwright
