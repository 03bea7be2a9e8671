// The look at a TOML text before the parser sees it. It follows strings, comments and brackets
// exactly as far as the text is valid; behind the first syntax error it may misjudge, but there the
// parser stops as well.
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
        line_is_blank_ = false;
        skip_string(c);
      } else if (!is_ascii(c)) {
        refuse_stray_character();
      } else {
        follow(c);
        ++at_;
      }
    }
  }

 private:
  // Passes over a string or a comment, whose letters may be anything that is UTF-8.
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
    if (sanitize(letters) != letters) {
      fail({&source_, line_}, "this line is not valid UTF-8 text; save the file as UTF-8");
    }
  }

  void refuse_stray_character() const {
    std::size_t end = at_;
    while (end < text_.size() && !is_ascii(text_[end])) {
      ++end;
    }
    const std::string_view letters = text_.substr(at_, end - at_);
    check_utf8(letters);
    fail({&source_, line_}, "'" + shorten(letters) +
                                "' stands outside quotes; keys are made of a-z A-Z 0-9 _ -, "
                                "anything else needs quotes");
  }

  void skip_string(char quote) {
    const std::string_view rest = text_.substr(at_);
    const std::string three(3, quote);
    if (rest.starts_with(three)) {
      std::size_t end = find_end(at_ + 3, three);
      for (int extra = 0; extra < 2 && end < text_.size() && text_[end] == quote; ++extra) {
        ++end;  // up to two quotes may stand right before the closing three
      }
      skip_to(end);
    } else {
      skip_to(find_end(at_ + 1, std::string_view(three).substr(0, 1)));
    }
  }

  // Where the string ends that is closed by `closing`; a string of one line also ends with its
  // line.
  std::size_t find_end(std::size_t from, std::string_view closing) const {
    while (from < text_.size()) {
      if (text_[from] == '\\' && closing[0] == '"') {
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

  void follow(char c) {
    switch (c) {
      case '\n':
        ++line_;
        line_is_blank_ = true;
        in_header_ = false;
        key_depth_ = 0;
        dots_ = 0;
        return;
      case ' ':
      case '\t':
      case '\r':
        return;
      case '.':
        ++dots_;
        break;
      case '=':
        key_depth_ = dots_;
        dots_ = 0;
        break;
      case ',':
        key_depth_ = 0;
        dots_ = 0;
        break;
      case '[':
      case '{':
        open();
        break;
      case ']':
      case '}':
        close();
        break;
      default:
        break;
    }
    line_is_blank_ = false;
    if (header_depth_ + open_depth_ + key_depth_ + dots_ > kDepthLimit) {
      fail({&source_, line_}, "tables and arrays nest deeper than " + std::to_string(kDepthLimit) +
                                  " levels (each dot in a key is one)");
    }
  }

  void open() {
    if (line_is_blank_ && brackets_.empty()) {
      in_header_ = true;
      header_depth_ = 0;
    } else if (!in_header_) {
      brackets_.push_back(key_depth_ + 1);
      open_depth_ += brackets_.back();
    }
    key_depth_ = 0;
    dots_ = 0;
  }

  void close() {
    if (in_header_) {
      header_depth_ = dots_ + 1;
      in_header_ = false;
    } else if (!brackets_.empty()) {
      open_depth_ -= brackets_.back();
      brackets_.pop_back();
    }
    key_depth_ = 0;
    dots_ = 0;
  }

  const Source& source_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
  bool line_is_blank_ = true;
  bool in_header_ = false;
  std::size_t header_depth_ = 0;       // of the [table] the current line belongs to
  std::vector<std::size_t> brackets_;  // the levels each open bracket adds, its dotted key included
  std::size_t open_depth_ = 0;         // their sum
  std::size_t key_depth_ = 0;          // dots of the key left of the last '='
  std::size_t dots_ = 0;               // dots since the last delimiter
};

}  // namespace

void check_text(const Source& source) {
  Scanner(source).scan();
}

}  // namespace armwright::config
