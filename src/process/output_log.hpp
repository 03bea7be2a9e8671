// The log of what optimizers' processes print. The output comes through a pipe and goes into a file
// of limited size: its beginning and its end are kept.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_descriptor.hpp"

namespace armwright {

class OutputLog {
 public:
  static constexpr std::size_t kHeadBytes = std::size_t{1} << 20;
  static constexpr std::size_t kTailBytes = std::size_t{64} << 10;

  enum class Begin { anew, behind_what_is_there };

  // Keeps only the last lines, for messages, without a file.
  OutputLog() = default;
  // Writes to `file`; an empty name means no file. With `anew`, removes the file of an earlier run
  // and makes a file with the first output; that file is never a link. With `behind_what_is_there`,
  // the user named the file, which may be a link or a device. Throws Error{io}.
  OutputLog(std::filesystem::path file, Begin begin);
  ~OutputLog();  // writes the end of the output, after a line that says how much is left out
  OutputLog(const OutputLog&) = delete;
  OutputLog& operator=(const OutputLog&) = delete;

  void add(std::string_view printed);  // throws Error{io}
  // Returns the last lines, at most ten, safe to show on a terminal.
  std::vector<std::string> last_lines() const;

 private:
  void open();
  void write(std::string_view text);

  std::filesystem::path file_;
  Begin begin_ = Begin::anew;
  FileDescriptor descriptor_;
  std::size_t head_bytes_ = 0;
  std::size_t later_bytes_ = 0;  // printed after the head was full
  std::string tail_;             // the last of everything, between one and two times kTailBytes
};

// Returns "; the last that it printed:" and the lines, one per line. Empty if there are no lines.
std::string describe_printed(const std::vector<std::string>& lines);

// A pipe into a log. A child writes into one end. This process reads the other end while it waits
// for the child.
class OutputPipe {
 public:
  explicit OutputPipe(OutputLog& log);  // Error{io}

  int child_end() const { return child_end_.get(); }
  void close_child_end() { child_end_.close(); }
  int get() const { return our_end_.get(); }  // for poll(); -1 at the end
  // Reads what is available, or a large part of it. Throws Error{io} of the log.
  void take_available();

 private:
  OutputLog& log_;
  FileDescriptor our_end_;
  FileDescriptor child_end_;
};

}  // namespace armwright
