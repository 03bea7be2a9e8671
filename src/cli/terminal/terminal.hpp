// What the standard streams are connected to, how text may be dressed for them, and writing to
// them. Results go to stdout, all else to stderr.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

enum class Stream { out = 1, error = 2 };

bool is_terminal(Stream stream);
int get_width(Stream stream);  // columns; 80 if unknown
// For text in lines that nobody reads by machine: a terminal's width, 100 anywhere else.
int get_text_width(Stream stream);

// Escape codes for emphasis, or none.
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

// `choice` is always, never or auto: on a terminal that is not dumb, unless NO_COLOR is set
// (no-color.org).
Style make_style(Stream stream, std::string_view choice);

struct BrokenPipe {
};  // thrown when nobody reads our stdout any more: the end, but nothing to complain about

// Error{io} if the text cannot be written; BrokenPipe.
void write_stdout(std::string_view text);
// Never fails: there is nowhere left to say so.
void write_stderr(std::string_view text);
// "armwright: TEXT" on stderr; what could be an escape code is made harmless.
void write_message(std::string_view text);

// To a file, whole or not at all; "-" is stdout. Devices and pipes are written to as they are.
void write_output(const std::string& file, std::string_view text);

}  // namespace armwright
