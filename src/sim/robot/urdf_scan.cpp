// Bounds the size and the nesting of a URDF before a parser sees it.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "base/text.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

class Scanner {
 public:
  Scanner(std::string_view xml, const std::string& name) : rest_(xml), name_(name) {}

  void scan() {
    while (!rest_.empty()) {
      if (rest_.starts_with("<!--")) {
        skip_past("-->", "a comment");
      } else if (rest_.starts_with("<![CDATA[")) {
        skip_past("]]>", "a CDATA section");
      } else if (rest_.starts_with("<?")) {
        skip_past("?>", "a processing instruction");
      } else if (rest_.starts_with("<!")) {
        fail("document types and entity declarations (<!...>) are not allowed; remove them");
      } else if (rest_.starts_with("</")) {
        skip_past(">", "a closing tag");
        if (!open_.empty()) {
          open_.pop_back();
        }
      } else if (rest_.front() == '<') {
        scan_tag();
      } else {
        check_entity();
        advance(1);
      }
    }
    if (!open_.empty()) {
      fail(fmt::format("the file ends inside <{}>, opened in line {}; is it truncated?",
                       sanitize(open_.back().tag), open_.back().line));
    }
  }

 private:
  struct OpenElement {
    std::string_view tag;
    int line;
  };

  [[noreturn]] void fail(const std::string& what) const { fail_urdf(name_, line_, what); }

  void advance(std::size_t count) {
    line_ +=
        static_cast<int>(std::count(rest_.begin(), rest_.begin() + static_cast<long>(count), '\n'));
    rest_.remove_prefix(count);
  }

  void skip_past(std::string_view end, std::string_view what) {
    const std::size_t at = rest_.find(end);
    if (at == std::string_view::npos) {
      fail(fmt::format("the file ends inside {} that begins here; is it truncated?", what));
    }
    advance(at + end.size());
  }

  // Skips an opening tag up to its '>'. A '>' inside quotes does not end the tag.
  void scan_tag() {
    const OpenElement element{rest_.substr(1, rest_.find_first_of(" \t\r\n/>", 1) - 1), line_};
    if (++elements_ > kUrdfElementLimit) {
      fail(fmt::format("has more than {} elements", kUrdfElementLimit));
    }
    char quote = 0;
    char previous = 0;
    std::size_t values = 0;
    while (!rest_.empty()) {
      const char c = rest_.front();
      check_entity();
      if (quote != 0) {
        quote = c == quote ? '\0' : quote;
      } else if (c == '"' || c == '\'') {
        quote = c;
        if (++values > kUrdfAttributeLimit) {
          fail(fmt::format("an element has more than {} attributes", kUrdfAttributeLimit));
        }
      } else if (c == '>') {
        advance(1);
        if (previous != '/') {
          open_.push_back(element);
          if (open_.size() > kUrdfDepthLimit) {
            fail(fmt::format("elements are nested deeper than {}, the limit for a robot",
                             kUrdfDepthLimit));
          }
        }
        return;
      }
      previous = c;
      advance(1);
    }
    line_ = element.line;
    fail(fmt::format("the file ends inside the tag <{} that begins here; is it truncated?",
                     sanitize(element.tag.substr(0, 40))));
  }

  // Throws for a NUL byte and for an unknown entity. Without a document type only the five
  // predefined entities and numeric character references are valid.
  void check_entity() const {
    if (rest_.front() == '\0') {
      fail("contains a NUL byte; a robot is plain text in UTF-8");
    }
    if (rest_.front() != '&') {
      return;
    }
    for (const std::string_view known : {"&lt;", "&gt;", "&amp;", "&quot;", "&apos;", "&#"}) {
      if (rest_.starts_with(known)) {
        return;
      }
    }
    fail("'&' begins an unknown entity; allowed are &lt; &gt; &amp; &quot; &apos; and &#...;");
  }

  std::string_view rest_;
  const std::string& name_;
  int line_ = 1;
  std::size_t elements_ = 0;
  std::vector<OpenElement> open_;
};

}  // namespace

void scan_urdf(std::string_view xml, const std::string& name) {
  if (xml.size() > kUrdfLimit_bytes) {
    fail_urdf(
        name, 1,
        fmt::format("has {} bytes; the limit for a robot is {}", xml.size(), kUrdfLimit_bytes));
  }
  if (xml.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    fail_urdf(name, 1, "is empty; a URDF has one <robot> element");
  }
  Scanner(xml, name).scan();
}

}  // namespace armwright
