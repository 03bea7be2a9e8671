// The standard streams: what they are connected to, colours, and writing. Results go to stdout,
// progress and messages to stderr.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

enum class Stream { in = 0, out = 1, error = 2 };

// Returns whether the stream is a terminal that can redraw a line. Returns false under mpirun and
// for TERM=dumb.
bool is_terminal(Stream stream);
// Returns the terminal's width in columns, or 80 if it is unknown.
int get_width(Stream stream);
// Returns the width for wrapped text: that of the terminal, or 100 columns elsewhere.
int get_text_width(Stream stream);

// Emphasis by escape codes, or no emphasis if it is off.
class Style {
 public:
  explicit Style(bool on) : on_(on) {}
  std::string bold(std::string_view text) const { return wrap("1", text); }
  std::string dim(std::string_view text) const { return wrap("2", text); }
  std::string red(std::string_view text) const { return wrap("31", text); }
  std::string green(std::string_view text) const { return wrap("32", text); }
  std::string yellow(std::string_view text) const { return wrap("33", text); }

 private:
  std::string wrap(std::string_view code, std::string_view text) const;
  bool on_;
};

// Returns the style for --color: `choice` is always, never or auto. With auto, the style is on if
// the stream is a terminal and NO_COLOR is not set (no-color.org).
Style make_style(Stream stream, std::string_view choice);

// Thrown when the reader of stdout has closed its end. The program then ends without a message.
struct BrokenPipe {};

// Throws Error{io} if the text cannot be written, and BrokenPipe.
void write_stdout(std::string_view text);
// Ignores errors, as there is no other place to report them.
void write_stderr(std::string_view text);
// Writes "armwright: TEXT" to stderr. Control characters are replaced, so that no escape code
// reaches the terminal.
void write_message(std::string_view text);

// Writes the question to stderr and reads the answer from stdin. Returns true for "y" or "yes".
// Returns false without asking if stdin or stderr is no terminal.
bool ask_on_terminal(std::string_view question);

// Writes the text to a file, whole or not at all; "-" is stdout. Devices and pipes are written to
// directly. Throws Error{io}, and BrokenPipe for "-".
void write_output(const std::string& file, std::string_view text);

}  // namespace armwright
