#include "e2e/program.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "wait_until.hpp"

namespace armwright {
namespace {

void check(int error, const char* doing) {
  if (error != 0) {
    throw std::system_error(error, std::generic_category(), doing);
  }
}

std::vector<std::string> make_environment(const std::filesystem::path& folder,
                                          const Environment& environment) {
  // Studies that a test starts are not remembered as the user's own.
  std::vector<std::string> variables = {"XDG_STATE_HOME=" + (folder / ".state").string()};
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    const bool is_replaced = std::ranges::any_of(environment.variables, [&](const auto& one) {
      return text.substr(0, text.find('=')) == one.first;
    });
    if (!is_replaced && !text.starts_with("XDG_STATE_HOME=") && !text.starts_with("ARMWRIGHT_") &&
        !text.starts_with("NO_COLOR=") && !text.starts_with("TERM=")) {
      variables.emplace_back(text);
    }
  }
  variables.emplace_back("TERM=xterm");
  for (const auto& [name, value] : environment.variables) {
    variables.push_back(name + "=" + value);
  }
  return variables;
}

std::vector<char*> make_pointers(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  return pointers;
}

int decode(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

// Starts it with the three streams as they are given: paths, or descriptors.
class Spawn {
 public:
  Spawn() {
    check(posix_spawn_file_actions_init(&actions_), "file_actions_init");
    check(posix_spawnattr_init(&attributes_), "spawnattr_init");
  }
  ~Spawn() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  Spawn(const Spawn&) = delete;
  Spawn& operator=(const Spawn&) = delete;

  void open(int descriptor, const std::string& file, int flags) {
    check(posix_spawn_file_actions_addopen(&actions_, descriptor, file.c_str(), flags, 0600),
          "open");
  }
  void duplicate(int from, int to) {
    check(posix_spawn_file_actions_adddup2(&actions_, from, to), "dup2");
  }
  int start(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
            const Environment& environment) {
    check(posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str()), "chdir");
    // What the test's own starter left open is not the program's.
    check(posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1), "closefrom");
    sigset_t all;
    sigset_t none;
    sigfillset(&all);
    sigdelset(&all, SIGKILL);
    sigdelset(&all, SIGSTOP);
    sigemptyset(&none);
    check(posix_spawnattr_setsigdefault(&attributes_, &all), "setsigdefault");
    check(posix_spawnattr_setsigmask(&attributes_, &none), "setsigmask");
    int flags = POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK;
    flags |= environment.own_group ? POSIX_SPAWN_SETPGROUP : 0;  // by default the child's number
    check(posix_spawnattr_setflags(&attributes_, static_cast<short>(flags)), "setflags");
    const bool direct = environment.launcher.empty();
    std::vector<std::string> words = environment.launcher;
    words.emplace_back(direct ? "armwright" : ARMWRIGHT_BINARY);
    words.insert(words.end(), arguments.begin(), arguments.end());
    const std::string program = direct ? ARMWRIGHT_BINARY : words.front();
    std::vector<std::string> variables = make_environment(folder, environment);
    int pid = -1;
    check(posix_spawnp(&pid, program.c_str(), &actions_, &attributes_, make_pointers(words).data(),
                       make_pointers(variables).data()),
          "posix_spawn");
    return pid;
  }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

}  // namespace

Program::Program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                 const Environment& environment) {
  static std::atomic<int> counter = 0;
  files_ = folder / (".streams-" + std::to_string(++counter));
  std::filesystem::create_directory(files_);
  Spawn spawn;
  spawn.open(STDIN_FILENO, "/dev/null", O_RDONLY);
  const std::string out =
      environment.out_file.empty() ? (files_ / "out").string() : environment.out_file;
  spawn.open(STDOUT_FILENO, out, O_WRONLY | O_CREAT);
  spawn.open(STDERR_FILENO, files_ / "err", O_WRONLY | O_CREAT);
  pid_ = spawn.start(folder, arguments, environment);
}

Program::~Program() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
}

void Program::send(int signal) const {
  check(::kill(pid_, signal) == 0 ? 0 : errno, "kill");
}

void Program::send_group(int signal) const {
  check(::kill(-pid_, signal) == 0 ? 0 : errno, "kill");
}

bool Program::is_running() const {
  siginfo_t info{};
  check(
      ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 ? 0 : errno,
      "waitid");
  return info.si_pid == 0;
}

Outcome Program::wait() {
  int status = 0;
  rusage usage{};
  while (::wait4(pid_, &status, 0, &usage) < 0) {
    if (errno != EINTR) {
      check(errno, "wait4");
    }
  }
  pid_ = -1;
  return {decode(status), read_text(files_ / "out"), read_text(files_ / "err"),
          1024 * static_cast<std::size_t>(usage.ru_maxrss)};
}

void wait_for_address(const std::filesystem::path& folder) {
  EXPECT_TRUE(wait_until([&] {
    return std::ranges::any_of(std::filesystem::directory_iterator(folder), [](const auto& entry) {
      return read_text(entry.path() / "out").find("http://") != std::string::npos;
    });
  }));
}

Outcome run_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                    const Environment& environment) {
  return Program(folder, arguments, environment).wait();
}

std::string run_on_terminal(const std::filesystem::path& folder,
                            const std::vector<std::string>& arguments,
                            const Environment& environment, unsigned short columns,
                            const std::string& typed) {
  int ours = -1;
  int theirs = -1;
  winsize size{};
  size.ws_col = columns;
  size.ws_row = 30;
  check(openpty(&ours, &theirs, nullptr, nullptr, &size) == 0 ? 0 : errno, "openpty");
  Spawn spawn;
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    spawn.duplicate(theirs, stream);
  }
  const int pid = spawn.start(folder, arguments, environment);
  ::close(theirs);
  check(::write(ours, typed.data(), typed.size()) < 0 ? errno : 0, "write");
  bool waits = !environment.interrupt_at.empty();
  std::string shown;
  char buffer[4096];
  // A terminal whose last program has gone answers with EIO.
  for (ssize_t got = 0; (got = ::read(ours, buffer, sizeof buffer)) > 0;) {
    shown.append(buffer, static_cast<std::size_t>(got));
    if (waits && shown.find(environment.interrupt_at) != std::string::npos) {
      check(::kill(pid, SIGINT) == 0 ? 0 : errno, "kill");
      waits = false;
    }
  }
  ::close(ours);
  ::waitpid(pid, nullptr, 0);
  return shown;
}

std::string read_text(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

std::string read_with(const std::string& reader, const std::filesystem::path& folder) {
  const std::string command = std::string("/usr/bin/python3 ") + ARMWRIGHT_TEST_DATA +
                              "/../report/" + reader + " '" + folder.string() + "' 2>&1";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) {
    text += static_cast<char>(c);
  }
  return text;
}

std::map<std::string, std::string> read_study(const std::filesystem::path& study) {
  std::map<std::string, std::string> tables;
  for (const auto& entry : std::filesystem::directory_iterator(study / "tables")) {
    tables[entry.path().filename().string()] = read_text(entry.path());
  }
  tables["result.json"] = read_text(study / "result.json");
  tables["verdict.txt"] = read_text(study / "verdict.txt");
  return tables;
}

}  // namespace armwright
