// Checks a TOML text before it is parsed. The scanner follows strings, comments and brackets
// exactly as long as the text is valid. After the first syntax error it may be wrong, but the
// parser stops there too.
#include <fmt/format.h>

#include <algorithm>

#include "base/config_tree.hpp"
#include "base/text.hpp"

namespace armwright::config {
namespace {

bool is_ascii(char c) {
  return static_cast<unsigned char>(c) < 0x80;
}

class Scanner {
 public:
  explicit Scanner(const Source& source) : source_(source), text_(source.text) {}

  void scan() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '#') {
        skip_to(std::min(text_.find('\n', at_), text_.size()));
      } else if (c == '"' || c == '\'') {
        check_beginning(c);
        line_is_blank_ = false;
        skip_string(c);
        previous_ = c;
      } else if (!is_ascii(c)) {
        refuse_stray_character();
      } else {
        follow(c);
        ++at_;
      }
    }
  }

 private:
  // Skips a string or a comment. Any UTF-8 text is allowed there.
  void skip_to(std::size_t end) {
    while (at_ < end) {
      if (text_[at_] == '\n') {
        ++line_;
      }
      if (is_ascii(text_[at_])) {
        ++at_;
        continue;
      }
      const std::size_t first = at_;
      while (at_ < end && !is_ascii(text_[at_])) {
        ++at_;
      }
      check_utf8(text_.substr(first, at_ - first));
    }
  }

  void check_utf8(std::string_view letters) const {
    if (!is_utf8(letters)) {
      fail({&source_, line_}, "this line is not valid UTF-8 text; save the file as UTF-8");
    }
  }

  void refuse_stray_character() const {
    const auto is_of_word = [this](std::size_t i) {
      return !is_ascii(text_[i]) || is_bare_key(text_.substr(i, 1));
    };
    std::size_t first = at_, end = at_;
    while (first > 0 && is_of_word(first - 1)) {
      --first;
    }
    while (end < text_.size() && is_of_word(end)) {
      ++end;
    }
    const std::string_view letters = text_.substr(first, end - first);
    check_utf8(letters);
    fail({&source_, line_}, "'" + shorten(letters) +
                                "' stands outside quotes; keys are made of a-z A-Z 0-9 _ -, "
                                "anything else needs quotes");
  }

  // Refuses a string, an array or a table that begins in the middle of another value. The parser
  // would read on inside it before it refuses it, and would misread its characters.
  void check_beginning(char c) const {
    const bool may_begin =
        in_value_
            ? std::string_view("=,[").find(previous_) != std::string_view::npos
            : line_is_blank_ || std::string_view(",[{.").find(previous_) != std::string_view::npos;
    if (!may_begin) {
      fail({&source_, line_},
           fmt::format("{} stands where nothing can begin with it; is a comma or a quote missing?",
                       c));
    }
  }

  void skip_string(char quote) {
    const std::string_view rest = text_.substr(at_);
    const std::string three(3, quote);
    if (rest.starts_with(three)) {
      std::size_t end = find_end(at_ + 3, three);
      for (int extra = 0; extra < 2 && end < text_.size() && text_[end] == quote; ++extra) {
        ++end;  // up to two quotes may precede the closing three
      }
      skip_to(end);
    } else {
      skip_to(find_end(at_ + 1, std::string_view(three).substr(0, 1)));
    }
  }

  // Returns the end of the string that `closing` closes. A string of one line also ends with its
  // line.
  std::size_t find_end(std::size_t from, std::string_view closing) const {
    while (from < text_.size()) {
      if (text_[from] == '\\' && closing[0] == '"') {
        check_escape(from);
        from += 2;
      } else if (text_.substr(from).starts_with(closing)) {
        return from + closing.size();
      } else if (text_[from] == '\n' && closing.size() == 1) {
        return from;
      } else {
        ++from;
      }
    }
    return text_.size();
  }

  // After a backslash at the end of a line the parser skips blanks. It cannot tell which characters
  // beyond ASCII are blanks.
  void check_escape(std::size_t backslash) const {
    const std::size_t next = text_.find_first_not_of(" \t\r\n", backslash + 1);
    if (next != std::string_view::npos && !is_ascii(text_[next])) {
      const auto lines = std::count(text_.begin() + at_, text_.begin() + next, '\n');
      fail({&source_, line_ + lines},
           "a letter beyond ASCII behind a backslash; write the text without this backslash");
    }
  }

  void follow(char c) {
    switch (c) {
      case '\n':
        ++line_;
        line_is_blank_ = true;
        in_header_ = false;
        in_value_ = in_value_ && !brackets_.empty();
        key_depth_ = 0;
        dots_ = 0;
        return;
      case ' ':
        check_time_follows_date();
        return;
      case '\t':
      case '\r':
        return;
      case '.':
        ++dots_;
        break;
      case '=':
        if (in_value_) {
          fail({&source_, line_}, "= stands in a value; text needs quotes");
        }
        in_value_ = true;
        key_depth_ = dots_;
        dots_ = 0;
        break;
      case ',':
        in_value_ = !brackets_.empty() && brackets_.back().kind == '[';
        key_depth_ = 0;
        dots_ = 0;
        break;
      case 'T':
      case 't':
        check_time_follows_date();
        break;
      case '[':
      case '{':
        open(c);
        break;
      case ']':
      case '}':
        check_closing(c);
        close();
        break;
      default:
        break;
    }
    line_is_blank_ = false;
    previous_ = c;
    if (header_depth_ + open_depth_ + key_depth_ + dots_ > kDepthLimit) {
      fail({&source_, line_}, "tables and arrays nest deeper than " + std::to_string(kDepthLimit) +
                                  " levels (each dot in a key is one)");
    }
  }

  void open(char c) {
    if (line_is_blank_ && brackets_.empty()) {
      in_header_ = true;
      header_depth_ = 0;
      check_header_name();
    } else if (!in_header_) {
      check_beginning(c);
      brackets_.push_back({c, key_depth_ + 1});
      open_depth_ += brackets_.back().levels;
      in_value_ = c == '[';
    }
    key_depth_ = 0;
    dots_ = 0;
  }

  // Called at the T or the blank after what may be a date.
  void check_time_follows_date() const {
    constexpr std::string_view kDate = "0000-00-00";
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto shape = [&](std::size_t first, std::size_t length) {
      std::string text(text_.substr(first, length));
      std::replace_if(text.begin(), text.end(), is_digit, '0');
      return text;
    };
    if (at_ < kDate.size() || shape(at_ - kDate.size(), kDate.size()) != kDate) {
      return;
    }
    const bool just_a_date = text_[at_] == ' ' && !shape(at_ + 1, 1).starts_with('0');
    if (!just_a_date && shape(at_ + 1, 5) != "00:00") {
      fail({&source_, line_}, "expected a time behind the date");
    }
  }

  void check_header_name() const {
    const bool array = text_.substr(at_).starts_with("[[");
    const std::size_t next = text_.find_first_not_of(" \t", at_ + (array ? 2 : 1));
    if (next == std::string_view::npos || !is_ascii(text_[next])) {
      return;  // the parser, or this scanner, reports it later
    }
    const std::string_view first = text_.substr(next, 1);
    if (!is_bare_key(first) && first != "\"" && first != "'" && first != "]") {
      fail({&source_, line_},
           "expected the name of a table behind '[', saw '" + shorten(first) + "'");
    }
  }

  void check_closing(char c) const {
    if (c == '}' && (previous_ == ',' || previous_ == '[')) {
      fail({&source_, line_}, fmt::format("'}}' stands directly behind '{}'", previous_));
    }
  }

  void close() {
    if (in_header_) {
      header_depth_ = dots_ + 1;
      in_header_ = false;
    } else if (!brackets_.empty()) {
      open_depth_ -= brackets_.back().levels;
      brackets_.pop_back();
      in_value_ = true;
    }
    key_depth_ = 0;
    dots_ = 0;
  }

  struct Bracket {
    char kind;
    std::size_t levels;  // of depth that it adds, with those of its dotted key
  };

  const Source& source_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool line_is_blank_ = true;
  char previous_ = '\0';  // the last character that is not a blank, if the line has one
  bool in_header_ = false;
  bool in_value_ = false;  // right of a '=' or in an array
  std::vector<Bracket> brackets_;
  std::size_t header_depth_ = 0;  // of the [table] that the current line belongs to
  std::size_t open_depth_ = 0;    // of all brackets_
  std::size_t key_depth_ = 0;     // dots of the key left of the last '='
  std::size_t dots_ = 0;          // dots since the last delimiter
};

}  // namespace

void check_text(const Source& source) {
  Scanner(source).scan();
}

}  // namespace armwright::config
