// Helpers for the tests of faults: small runs of the real program, disks that fail, processes found
// by a mark, and the comparison with an undisturbed run.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include "base/temporary_folder.hpp"
#include "e2e/processes.hpp"
#include "e2e/program.hpp"
#include "sample_or_all.hpp"
#include "study/journal/journal.hpp"
#include "wait_until.hpp"

namespace armwright::faults {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Words = std::vector<std::string>;

inline Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// Returns 0 for a missing file.
std::uintmax_t get_size(const std::filesystem::path& file);
void write_text(const std::filesystem::path& file, const std::string& text);
// Returns a copy with another byte at `offset`.
void flip_byte(const std::filesystem::path& file, std::size_t offset);

std::string get_plugin(const std::string& name);  // "good": the library's file
std::string get_script(const std::string& name);  // "good.py"

// Runs the program from a shell that first executes a command such as "ulimit -n 8".
inline Environment after_shell(const std::string& commands) {
  Environment environment;
  environment.launcher = {"sh", "-c", commands + "; exec \"$@\"", "sh"};
  return environment;
}

// Returns the processor time in seconds of the programs that `action` runs.
double measure_children_s(const std::function<void()>& action);

// Returns the words that run the program as another user, because root is exempt from rights and
// limits. Empty if this process is not root.
Words become_ordinary_user();
// Gives that user the right to write there.
void open_to_all(const std::filesystem::path& folder);

// Returns the words of a short run of q1-complex that has every kind of derived file.
Words make_run(const std::string& out, const std::string& budget = "105");

// Lets the n-th call of one kind on files below a folder fail, or kill the process
// (failing_files.c).
class FailingFiles {
 public:
  // `folder` must exist.
  FailingFiles(const std::filesystem::path& folder, std::string call);
  enum class Fault { none, once, for_ever, kill };
  Environment make_environment(Fault fault, std::uint64_t at, int error);
  std::uint64_t count() const;  // of the calls since make_environment()

 private:
  std::string folder_;
  std::string call_;
  TemporaryFolder counter_;
};

// Finds the processes that were started with the variable FAULTS_MARK=mark, and their children.
inline std::vector<int> list_processes(const std::string& mark) {
  return list_processes_with("FAULTS_MARK=" + mark);
}

// Expects that both journals hold the same evaluations, and that the derived files are the same
// bytes.
void expect_same_run(const std::filesystem::path& a, const std::filesystem::path& b);
// Expects that every record of `part` is one of `whole`, bit by bit.
void expect_part_of(const JournalContent& part, const JournalContent& whole);

// Returns a comparison of two optimizers on a quick arm, sixteen cells with the baselines.
Words make_arm_comparison(const std::string& out, const std::string& jobs = "2");

// Returns the beginning of a problem file that tunes the shipped arm on a few short cases.
inline const std::string kShortProblem =
    "kind = \"tracking\"\nphysics.engine = \"articulated\"\nworkspace.points = 4\n"
    "sets.test_cases = 2\nsets.validation_cases = 1\n";

// Expects that no number in the text is NaN or infinite, in any notation.
void expect_finite_numbers(const std::filesystem::path& file);

}  // namespace armwright::faults
