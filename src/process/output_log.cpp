#include "process/output_log.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "base/file.hpp"
#include "base/text.hpp"

namespace armwright {

OutputLog::OutputLog(std::filesystem::path file, Begin begin)
    : file_(std::move(file)), begin_(begin) {
  if (file_.empty()) {
    return;
  }
  if (begin == Begin::behind_what_is_there) {
    open();
  } else if (unlink(file_.c_str()) != 0 && errno != ENOENT) {
    fail_io(file_, "remove", errno);
  }
}

OutputLog::~OutputLog() {
  if (!descriptor_.is_open() || later_bytes_ == 0) {
    return;
  }
  const std::size_t kept = std::min({later_bytes_, tail_.size(), kTailBytes});
  const std::string note =
      later_bytes_ == kept
          ? ""
          : fmt::format("\n[armwright: {} bytes are left out here]\n", later_bytes_ - kept);
  try {
    write(note + tail_.substr(tail_.size() - kept));
  } catch (const std::exception&) {
    // The disk is full. The run has reported that itself, or it has already stored all its results.
  }
}

void OutputLog::open() {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_APPEND;
  if (begin_ == Begin::anew) {
    const Folder folder(file_.parent_path());
    descriptor_.reset(folder.open(file_.filename().string(), kFlags).release());
    return;
  }
  descriptor_.reset(::open(file_.c_str(), kFlags | O_CLOEXEC, 0644));
  if (!descriptor_.is_open()) {
    fail_io(file_, "write", errno);
  }
}

void OutputLog::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor_.get(), text.data(), text.size());
    if (count < 0 && errno != EINTR) {
      fail_io(file_, "write", errno);
    }
    text.remove_prefix(count > 0 ? static_cast<std::size_t>(count) : 0);
  }
}

void OutputLog::add(std::string_view printed) {
  if (printed.empty()) {
    return;
  }
  tail_ += printed;
  if (tail_.size() > 2 * kTailBytes) {
    tail_.erase(0, tail_.size() - kTailBytes);
  }
  if (file_.empty()) {
    return;
  }
  if (!descriptor_.is_open()) {
    open();
  }
  const std::string_view head = printed.substr(0, kHeadBytes - head_bytes_);
  later_bytes_ += printed.size() - head.size();
  head_bytes_ += head.size();
  write(head);
}

std::vector<std::string> OutputLog::last_lines() const {
  constexpr std::size_t kMostLines = 10;
  constexpr std::size_t kLongestLine = 300;
  std::vector<std::string> lines;
  for (const std::string& line : split(tail_, '\n')) {
    if (!line.empty()) {
      lines.push_back(sanitize(std::string_view(line).substr(0, kLongestLine)));
    }
  }
  if (lines.size() > kMostLines) {
    lines.erase(lines.begin(), lines.end() - kMostLines);
  }
  return lines;
}

std::string describe_printed(const std::vector<std::string>& lines) {
  return lines.empty() ? "" : "; the last that it printed:\n  " + join(lines, "\n  ");
}

OutputPipe::OutputPipe(OutputLog& log) : log_(log) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    fail_io("a pipe", "open", errno);
  }
  our_end_.reset(ends[0]);
  child_end_.reset(ends[1]);
  fcntl(our_end_.get(), F_SETFL, O_NONBLOCK);
}

void OutputPipe::take_available() {
  constexpr int kMostReads = 16;  // a child that prints without end must not block this function
  std::array<char, 65536> buffer;
  for (int i = 0; our_end_.is_open() && i < kMostReads; ++i) {
    const ssize_t count = read(our_end_.get(), buffer.data(), buffer.size());
    if (count > 0) {
      log_.add({buffer.data(), static_cast<std::size_t>(count)});
    } else if (count == 0) {
      our_end_.close();
    } else if (errno != EINTR) {
      return;  // nothing more for now
    }
  }
}

}  // namespace armwright
