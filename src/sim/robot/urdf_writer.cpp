#include "sim/robot/urdf_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "sim/robot/urdf.hpp"

namespace armwright {
namespace {

constexpr std::string_view kXmlBlanks = " \t\r\n";

// A tag: "<NAME ...>", "<NAME .../>" or "</NAME>".
struct Tag {
  std::size_t begin = 0;
  std::size_t end = 0;  // after the '>'
  std::string_view name;
  bool opens = true;
  bool closes = false;
};

// Iterates over the tags of a text. scan_urdf() has accepted the text, so comments, CDATA sections,
// processing instructions and quotes are closed.
class Tags {
 public:
  explicit Tags(std::string_view xml) : xml_(xml) {}

  std::optional<Tag> next() {
    while ((at_ = xml_.find('<', at_)) != std::string_view::npos) {
      const std::string_view rest = xml_.substr(at_);
      if (rest.starts_with("<!--")) {
        at_ = xml_.find("-->", at_ + 4) + 3;
      } else if (rest.starts_with("<![CDATA[")) {
        at_ = xml_.find("]]>", at_) + 3;
      } else if (rest.starts_with("<?")) {
        at_ = xml_.find("?>", at_ + 2) + 2;
      } else {
        return read();
      }
    }
    return std::nullopt;
  }

 private:
  Tag read() {
    Tag tag;
    tag.begin = at_;
    tag.opens = xml_[at_ + 1] != '/';
    const std::size_t name = at_ + (tag.opens ? 1 : 2);
    tag.name = xml_.substr(name, xml_.find_first_of(" \t\r\n/>", name) - name);
    char quote = 0;
    for (; quote != 0 || xml_[at_] != '>'; ++at_) {
      const char c = xml_[at_];
      if (quote != 0) {
        quote = c == quote ? '\0' : quote;
      } else if (tag.opens && (c == '"' || c == '\'')) {
        quote = c;
      }
    }
    const bool is_whole = xml_[at_ - 1] == '/';
    tag.closes = !tag.opens || is_whole;
    tag.opens = tag.opens || is_whole;  // the parser takes "</NAME .../>" for an element
    tag.end = ++at_;
    return tag;
  }

  std::string_view xml_;
  std::size_t at_ = 0;
};

struct TextRange {
  std::size_t begin = 0, end = 0;
};

// Returns the place of an attribute's value, without its quotes.
std::optional<TextRange> find_attribute(std::string_view xml, const Tag& tag,
                                        std::string_view wanted) {
  std::size_t at = tag.begin + 1 + tag.name.size();
  while (true) {
    at = xml.find_first_not_of(kXmlBlanks, at);
    if (at >= tag.end || xml[at] == '>' || xml[at] == '/') {
      return std::nullopt;
    }
    const std::size_t name_end = xml.find_first_of(" \t\r\n=", at);
    const std::size_t open = xml.find_first_of("\"'", name_end);
    const std::size_t close = xml.find(xml[open], open + 1);
    if (xml.substr(at, name_end - at) == wanted) {
      return TextRange{open + 1, close};
    }
    at = close + 1;
  }
}

void append_utf8(std::string& text, unsigned long code) {
  const auto push = [&](unsigned long byte) { text += static_cast<char>(byte); };
  if (code < 0x80) {
    push(code);
  } else if (code < 0x800) {
    push(0xc0 | code >> 6);
    push(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    push(0xe0 | code >> 12);
    push(0x80 | (code >> 6 & 0x3f));
    push(0x80 | (code & 0x3f));
  } else {
    push(0xf0 | code >> 18);
    push(0x80 | (code >> 12 & 0x3f));
    push(0x80 | (code >> 6 & 0x3f));
    push(0x80 | (code & 0x3f));
  }
}

// Returns an attribute's text with the predefined entities and numeric character references
// replaced.
std::string decode(std::string_view raw) {
  static const std::map<std::string_view, char> known = {
      {"lt", '<'}, {"gt", '>'}, {"amp", '&'}, {"quot", '"'}, {"apos", '\''}};
  std::string text;
  for (std::size_t at = 0; at < raw.size();) {
    const std::size_t end = raw[at] == '&' ? raw.find(';', at) : std::string_view::npos;
    if (end == std::string_view::npos) {
      text += raw[at++];
      continue;
    }
    const std::string entity(raw.substr(at + 1, end - at - 1));
    if (const auto found = known.find(entity); found != known.end()) {
      text += found->second;
    } else {
      const bool hexadecimal = entity.starts_with("#x");
      append_utf8(text, std::strtoul(entity.c_str() + (hexadecimal ? 2 : 1), nullptr,
                                     hexadecimal ? 16 : 10));
    }
    at = end + 1;
  }
  return text;
}

struct Edit {
  TextRange place;
  std::string text;
};

// Returns the blanks before a tag if nothing else stands before it in its line.
std::optional<std::string_view> find_indent(std::string_view xml, const Tag& tag) {
  const std::size_t before =
      tag.begin == 0 ? std::string_view::npos : xml.find_last_not_of(" \t", tag.begin - 1);
  if (before == std::string_view::npos || xml[before] != '\n') {
    return std::nullopt;
  }
  return xml.substr(before + 1, tag.begin - before - 1);
}

// Inserts an element before a closing tag, on a line of its own if the tag has its own line.
Edit insert_before(std::string_view xml, const Tag& closing, std::string text) {
  if (const auto indent = find_indent(xml, closing)) {
    const std::size_t line_end = closing.begin - indent->size();  // after the '\n'
    const bool crlf = line_end > 1 && xml[line_end - 2] == '\r';
    text = fmt::format("  {}{}{}", text, crlf ? "\r\n" : "\n", *indent);
  }
  return {{closing.begin, closing.begin}, std::move(text)};
}

Edit insert_limit(std::string_view xml, const Tag& closing, const std::string& effort) {
  return insert_before(xml, closing,
                       fmt::format("<limit effort=\"{}\" velocity=\"{}\"/>", effort,
                                   format_exact(kNoVelocityLimit_rad_per_s)));
}

// Returns one edit per joint in `efforts` and removes the joint from `efforts`.
std::vector<Edit> find_edits(std::string_view xml, std::map<std::string, double>& efforts) {
  constexpr std::size_t kJointDepth = 2;  // <robot><joint>
  std::vector<Edit> edits;
  Tags tags(xml);
  std::size_t depth = 0;
  std::string effort;  // of the current joint, if it needs an edit and has none yet
  while (const auto tag = tags.next()) {
    if (tag->opens) {
      ++depth;
      if (depth == kJointDepth && tag->name == "joint" && !tag->closes) {
        const auto name = find_attribute(xml, *tag, "name");
        const auto found =
            efforts.find(name ? decode(xml.substr(name->begin, name->end - name->begin)) : "");
        if (found != efforts.end()) {
          effort = format_exact(found->second);
          efforts.erase(found);
        }
      } else if (depth == kJointDepth + 1 && tag->name == "limit" && !effort.empty()) {
        if (const auto value = find_attribute(xml, *tag, "effort")) {
          edits.push_back({*value, std::exchange(effort, "")});
        }
      }
    }
    if (tag->closes) {
      if (depth == kJointDepth && !effort.empty()) {
        edits.push_back(insert_limit(xml, *tag, std::exchange(effort, "")));
      }
      --depth;
    }
  }
  return edits;
}

// Returns the text as an XML comment. XML forbids "--" in a comment, so a blank separates them.
std::string make_comment(std::string_view text) {
  std::string comment = "<!--\n";
  for (const char c : text) {
    comment += c == '-' && comment.back() == '-' ? " -" : std::string(1, c);
  }
  return comment + "\n-->\n";
}

// Returns the place after the declarations (<?...?>) at the beginning.
std::size_t find_beginning(std::string_view xml) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  const std::size_t start = xml.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  std::size_t end = start;
  for (std::size_t at = xml.find_first_not_of(kXmlBlanks, end);
       at != std::string_view::npos && xml.substr(at).starts_with("<?");
       at = xml.find_first_not_of(kXmlBlanks, end)) {
    end = xml.find("?>", at + 2) + 2;
  }
  if (end == start) {
    return start;
  }
  const std::size_t text = xml.find_first_not_of(" \t\r", end);
  return text != std::string_view::npos && xml[text] == '\n' ? text + 1 : end;
}

// Returns the text with the edits and the comment. Leaves out edits inside replaced text.
std::string apply(std::string_view xml, std::vector<Edit> edits, std::string_view comment) {
  const std::size_t beginning = find_beginning(xml);
  edits.push_back({{beginning, beginning}, make_comment(comment)});
  std::ranges::stable_sort(edits, {}, [](const Edit& edit) { return edit.place.begin; });
  std::string result;
  std::size_t copied = 0;
  for (const Edit& edit : edits) {
    if (edit.place.begin < copied) {
      continue;
    }
    result += xml.substr(copied, edit.place.begin - copied);
    result += edit.text;
    copied = edit.place.end;
  }
  result += xml.substr(copied);
  return result;
}

// Removes an element, and its lines if nothing else stands in them.
Edit remove_element(std::string_view xml, const Tag& opening, const Tag& closing) {
  TextRange place{opening.begin, closing.end};
  const auto indent = find_indent(xml, opening);
  const std::size_t after = xml.find_first_not_of(" \t\r", closing.end);
  if (indent && after != std::string_view::npos && xml[after] == '\n') {
    place = {opening.begin - indent->size(), after + 1};
  }
  return {place, ""};
}

Edit make_edit(std::string_view xml, const UrdfEdit& wanted, const Tag& opening,
               const Tag& closing) {
  if (wanted.kind == UrdfEdit::Kind::remove) {
    return remove_element(xml, opening, closing);
  }
  if (wanted.kind == UrdfEdit::Kind::replace) {
    return {{opening.begin, closing.end}, wanted.xml};
  }
  if (!opening.closes) {
    return insert_before(xml, closing, wanted.xml);
  }
  return {{opening.end - 2, opening.end}, fmt::format(">{}</{}>", wanted.xml, opening.name)};
}

}  // namespace

std::string set_effort_limits(std::string_view xml, const std::string& name,
                              std::map<std::string, double> efforts, std::string_view comment) {
  scan_urdf(xml, name);
  std::vector<Edit> edits = find_edits(xml, efforts);
  if (!efforts.empty()) {
    fail_urdf(name, 1, fmt::format("has no joint '{}'", sanitize(efforts.begin()->first)));
  }
  return apply(xml, std::move(edits), comment);
}

std::string apply_repairs(std::string_view xml, const std::string& name,
                          std::span<const UrdfRepair> repairs, std::string_view comment) {
  scan_urdf(xml, name);
  std::multimap<std::size_t, const UrdfEdit*> wanted;  // by element
  for (const UrdfRepair& repair : repairs) {
    for (const UrdfEdit& edit : repair.edits) {
      wanted.emplace(edit.element, &edit);
    }
  }
  struct Open {
    Tag tag;
    std::size_t element;
  };
  std::vector<Edit> edits;
  std::vector<Open> open;
  std::size_t count = 0;
  Tags tags(xml);
  while (const auto tag = tags.next()) {
    if (tag->opens) {
      open.push_back({*tag, count++});
    }
    if (tag->closes && !open.empty()) {  // the parser ignores what follows the root element
      const Open element = open.back();
      open.pop_back();
      const auto [first, last] = wanted.equal_range(element.element);
      for (auto edit = first; edit != last; ++edit) {
        edits.push_back(make_edit(xml, *edit->second, element.tag, *tag));
      }
    }
  }
  return apply(xml, std::move(edits), comment);
}

}  // namespace armwright
