// What an optimizer's processes print, on its way through a pipe into a file that does not grow
// without end, whatever they print: the beginning and the end are kept.
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

  // No file: only the last lines are kept, for messages.
  OutputLog() = default;
  // An empty name: likewise. Anew: what an earlier run left there is removed, and a file is made
  // once there is something to write. Error{io}.
  OutputLog(std::filesystem::path file, Begin begin);
  ~OutputLog();  // writes the end, with a line that says how much was left out before it
  OutputLog(const OutputLog&) = delete;
  OutputLog& operator=(const OutputLog&) = delete;

  void add(std::string_view printed);  // Error{io}
  // The last lines, fit for a terminal; at most ten.
  std::vector<std::string> last_lines() const;

 private:
  void open();
  void write(std::string_view text);

  std::filesystem::path file_;
  FileDescriptor descriptor_;
  std::size_t head_bytes_ = 0;
  std::size_t later_bytes_ = 0;  // printed after the head was full
  std::string tail_;             // the last of everything, between one and two times kTailBytes
};

// "; the last that it printed:" and the lines, each on a line of its own; nothing for no lines.
std::string describe_printed(const std::vector<std::string>& lines);

// A pipe into a log. A child writes into its one end; the other is read while the child is waited
// for.
class OutputPipe {
 public:
  explicit OutputPipe(OutputLog& log);  // Error{io}

  int child_end() const { return child_end_.get(); }
  void close_child_end() { child_end_.close(); }
  int get() const { return our_end_.get(); }  // for poll(); -1 at the end
  // What is there already, or a good part of it if there is much. Error{io} of the log.
  void take_available();

 private:
  OutputLog& log_;
  FileDescriptor our_end_;
  FileDescriptor child_end_;
};

}  // namespace armwright
