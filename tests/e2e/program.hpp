// Runs the real program as a user would, for end-to-end tests.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace armwright {

struct Outcome {
  int exit_code = -1;  // -N: ended by signal N
  std::string out;
  std::string err;
  std::size_t most_memory_bytes = 0;  // that it held at a time
};

// Returns whether a run has come to its end: with a winner that has no fault (exit code 0), or with
// one that has (3), for which a small budget is enough.
inline bool has_ended(const Outcome& outcome) {
  return outcome.exit_code == 0 || outcome.exit_code == 3;
}

struct Environment {
  std::vector<std::pair<std::string, std::string>> variables;  // beside the test's own
  std::string out_file;  // where stdout goes instead, "/dev/full"
  // What starts the program: words before its own, of a program on the PATH. A piece of shell sets
  // limits or closes streams: {"sh", "-c", "ulimit -v 1000000; exec \"$@\"", "sh"}.
  std::vector<std::string> launcher = {};
  bool own_group = false;  // it leads a process group of its own
  std::string interrupt_at =
      {};  // run_on_terminal() sends SIGINT once the terminal shows this text
};

// One running program. Its stdout and stderr go to files, so that it never waits for us; NO_COLOR,
// TERM and all ARMWRIGHT_* of the test's own environment are kept from it, and no signal is ignored
// or blocked.
class Program {
 public:
  Program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
          const Environment& environment = {});
  ~Program();  // kills it if it still runs
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  int pid() const { return pid_; }
  void send(int signal) const;
  void send_group(int signal) const;  // to all in the group that it leads
  bool is_running() const;
  Outcome wait();

 private:
  std::filesystem::path files_;
  int pid_ = -1;
};

// Waits until an `armwright watch` that runs in the folder has printed the address of its page.
void wait_for_address(const std::filesystem::path& folder);

Outcome run_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                    const Environment& environment = {});

// The same on a terminal: what it shows there (stdout and stderr together). `typed` is what a user
// types ahead.
std::string run_on_terminal(const std::filesystem::path& folder,
                            const std::vector<std::string>& arguments,
                            const Environment& environment = {}, unsigned short columns = 100,
                            const std::string& typed = "");

std::string read_text(const std::filesystem::path& file);

// What a reader in tests/report prints of an export: what it has read, or why it refuses to.
// Debian's own Python runs it, which has Debian's packages.
std::string read_with(const std::string& reader, const std::filesystem::path& folder);

// What a comparison has come to: its tables, result and verdict, by the names of their files.
std::map<std::string, std::string> read_study(const std::filesystem::path& study);

// Returns the words of a command, followed by more words.
inline std::vector<std::string> operator+(std::vector<std::string> words,
                                          const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace armwright
