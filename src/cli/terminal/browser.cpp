#include "cli/terminal/browser.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "base/text.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

// Returns the words of the command that shows the address. BROWSER is a list of commands with colons
// between them; "%s" in a command stands for the address, which otherwise comes last.
std::vector<std::string> make_browser_command(const std::string& url) {
  if (!is_set("BROWSER")) {
    return {"xdg-open", url};
  }
  std::vector<std::string> words = split(split(std::getenv("BROWSER"), ':').front(), ' ');
  std::erase(words, "");
  if (std::ranges::find(words, "%s") == words.end()) {
    words.emplace_back("%s");
  }
  std::ranges::replace(words, std::string("%s"), url);
  return words;
}

}  // namespace

void open_in_browser(const std::string& url) {
  const bool has_display = is_set("DISPLAY") || is_set("WAYLAND_DISPLAY") || is_set("BROWSER");
  if (!has_display || !is_terminal(Stream::out)) {
    return;
  }
  std::vector<std::string> words = make_browser_command(url);
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  // Ctrl-C ends the command and not the browser, which starts with the default signal actions.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigemptyset(&signals);
  posix_spawnattr_setsigmask(&attributes, &signals);
  for (const int one : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ}) {
    sigaddset(&signals, one);
  }
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setflags(
      &attributes,
      static_cast<short>(POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF));
  pid_t pid = -1;
  ::posix_spawnp(&pid, pointers[0], &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
}

}  // namespace armwright
