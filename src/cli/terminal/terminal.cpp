#include "cli/terminal/terminal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

// Returns 0 or the error number.
int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t put = ::write(descriptor, text.data(), text.size());
    if (put < 0 && errno == EINTR) {
      continue;
    }
    if (put < 0) {
      return errno;
    }
    text.remove_prefix(static_cast<std::size_t>(put));
  }
  return 0;
}

[[noreturn]] void refuse(std::string_view what, int error) {
  throw Error(ErrorKind::io,
              fmt::format("{}: cannot write it: {}", sanitize(what), std::strerror(error)));
}

}  // namespace

bool is_terminal(Stream stream) {
  const char* term = std::getenv("TERM");
  const bool dumb = term != nullptr && std::string_view(term) == "dumb";
  // Under mpirun, each rank sees a terminal even if its output goes elsewhere.
  const bool by_mpirun = std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr;
  return !dumb && !by_mpirun && ::isatty(static_cast<int>(stream)) == 1;
}

int get_width(Stream stream) {
  constexpr int kUsual = 80;
  winsize size{};
  if (::ioctl(static_cast<int>(stream), TIOCGWINSZ, &size) != 0 || size.ws_col == 0) {
    return kUsual;
  }
  return size.ws_col;
}

int get_text_width(Stream stream) {
  constexpr int kUsual = 100;
  return is_terminal(stream) ? get_width(stream) : kUsual;
}

std::string Style::wrap(std::string_view code, std::string_view text) const {
  return on_ ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : std::string(text);
}

Style make_style(Stream stream, std::string_view choice) {
  if (choice != "auto") {
    return Style(choice == "always");
  }
  const char* no_color = std::getenv("NO_COLOR");
  const bool unwanted = no_color != nullptr && *no_color != '\0';
  return Style(!unwanted && is_terminal(stream));
}

void write_stdout(std::string_view text) {
  const int error = write_all(STDOUT_FILENO, text);
  if (error == EPIPE) {
    throw BrokenPipe{};
  }
  if (error != 0) {
    refuse("standard output", error);
  }
}

void write_stderr(std::string_view text) {
  write_all(STDERR_FILENO, text);
}

void write_message(std::string_view text) {
  std::string lines;
  for (const std::string& line : split(text, '\n')) {
    lines += (lines.empty() ? "armwright: " : "  ") + sanitize(line) + '\n';
  }
  write_stderr(lines);
}

bool ask_on_terminal(std::string_view question) {
  if (!is_terminal(Stream::in) || !is_terminal(Stream::error)) {
    return false;
  }
  write_stderr(fmt::format("armwright: {} [y/N] ", sanitize(question)));
  constexpr std::size_t kLongest = 80;
  std::string answer;
  char letter = 0;
  while (answer.size() < kLongest && ::read(STDIN_FILENO, &letter, 1) == 1 && letter != '\n') {
    answer += letter;
  }
  return answer == "y" || answer == "Y" || answer == "yes";
}

void write_output(const std::string& file, std::string_view text) {
  if (file == "-") {
    write_stdout(text);
    return;
  }
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) {
    write_file_atomically(file, text);
    return;
  }
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) {
    refuse(file, errno);
  }
  const int written = write_all(descriptor, text);
  const int closed = ::close(descriptor) == 0 ? 0 : errno;
  if (written != 0 || closed != 0) {
    refuse(file, written != 0 ? written : closed);
  }
}

}  // namespace armwright
