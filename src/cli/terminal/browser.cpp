#include "cli/terminal/browser.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/file_descriptor.hpp"
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
  std::vector<std::string> words;
  if (is_set("BROWSER")) {
    words = split(split(std::getenv("BROWSER"), ':').front(), ' ');
    std::erase(words, "");
  }
  if (words.empty()) {
    return {"xdg-open", url};
  }
  bool has_url = false;
  for (std::string& word : words) {
    if (const std::size_t at = word.find("%s"); at != std::string::npos) {
      word.replace(at, 2, url);
      has_url = true;
    }
  }
  if (!has_url) {
    words.push_back(url);
  }
  return words;
}

// Writes a page that leads to the address and that only the user can read. Returns whether it could
// be written.
bool write_redirection(const std::filesystem::path& file, const std::string& url) {
  const std::string page = fmt::format(
      "<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<meta name=\"referrer\" "
      "content=\"no-referrer\">\n"
      "<meta http-equiv=\"refresh\" content=\"0; url={0}\">\n<title>armwright watch</title>\n"
      "<p><a href=\"{0}\">The page of armwright watch</a></p>\n",
      url);
  FileDescriptor out(
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  return out.is_open() &&
         ::write(out.get(), page.data(), page.size()) == static_cast<ssize_t>(page.size()) &&
         out.close() == 0;
}

// Returns the file's address (RFC 8089). All bytes but letters, digits and "-._~/" are escaped.
std::string make_file_url(const std::filesystem::path& file) {
  std::string url = "file://";
  for (const char c : std::filesystem::absolute(file).string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    url += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return url;
}

// Starts the command and waits for its end in a thread of its own. Returns whether it was started.
bool start(std::vector<std::string> words) {
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
  const bool started =
      ::posix_spawnp(&pid, pointers[0], &actions, &attributes, pointers.data(), environ) == 0;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (started) {
    std::thread([pid] { ::waitpid(pid, nullptr, 0); }).detach();
  }
  return started;
}

}  // namespace

OpenedAddress::OpenedAddress(const std::string& url) {
  const bool has_display = is_set("DISPLAY") || is_set("WAYLAND_DISPLAY") || is_set("BROWSER");
  if (!has_display || !is_terminal(Stream::out)) {
    return;
  }
  try {
    auto folder = std::make_unique<TemporaryFolder>();
    const auto file = *folder / "watch.html";
    if (write_redirection(file, url) && start(make_browser_command(make_file_url(file)))) {
      folder_ = std::move(folder);
    }
  } catch (const Error&) {
    // There is no folder for temporary files. The user has the address on the terminal.
  }
}

}  // namespace armwright
