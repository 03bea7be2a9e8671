#include "base/config_tree.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"

namespace armwright::config {
namespace {

constexpr std::string_view kOverrideExample = "write KEY=VALUE, as in --set task.speed_m_per_s=2";

bool is_bare_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

// Finds the text of a value. toml++ gives its line and column, and the column counts characters,
// not bytes.
class TextIndex {
 public:
  explicit TextIndex(std::string_view text) : text_(text) {
    first_of_line_.push_back(0);
    for (std::size_t at = 0; at < text.size(); ++at) {
      if ((static_cast<unsigned char>(text[at]) & 0xC0) != 0x80) {
        offsets_.push_back(at);
      }
      if (text[at] == '\n') {
        first_of_line_.push_back(offsets_.size());
      }
    }
  }

  std::string_view between(toml::source_position begin, toml::source_position end) const {
    const std::size_t first = offset(begin);
    return text_.substr(first, std::max(offset(end), first) - first);
  }

 private:
  std::size_t offset(toml::source_position position) const {
    if (position.line == 0 || position.line > first_of_line_.size() || position.column == 0) {
      return text_.size();
    }
    const std::size_t character = first_of_line_[position.line - 1] + position.column - 1;
    return character < offsets_.size() ? offsets_[character] : text_.size();
  }

  std::string_view text_;
  std::vector<std::size_t> offsets_;        // of each character
  std::vector<std::size_t> first_of_line_;  // number of the first character of each line
};

class Converter {
 public:
  explicit Converter(const Source& source) : source_(source), index_(source.text) {}

  Value convert(const toml::node& node, const std::string& path) const {
    Value value;
    value.place = {&source_, node.source().begin.line};
    value.written = index_.between(node.source().begin, node.source().end);
    if (const auto* table = node.as_table()) {
      value.kind = Kind::table;
      for (const auto& [key, child] : *table) {
        value.keys[std::string(key.str())] =
            std::make_unique<Value>(convert(child, join_path(path, key.str())));
      }
    } else if (const auto* array = node.as_array()) {
      value.kind = Kind::array;
      value.items.reserve(array->size());
      for (const auto& child : *array) {
        value.items.push_back(convert(child, fmt::format("{}[{}]", path, value.items.size())));
      }
    } else if (const auto* text = node.as_string()) {
      value.kind = Kind::string;
      value.string = text->get();
    } else if (const auto* integer = node.as_integer()) {
      value.kind = Kind::integer;
      value.integer = integer->get();
    } else if (const auto* number = node.as_floating_point()) {
      value.kind = Kind::number;
      value.number = number->get();
      if (!std::isfinite(value.number)) {
        fail(value.place,
             fmt::format("{} is {}; it must be a finite number", path, value.describe()));
      }
    } else if (const auto* boolean = node.as_boolean()) {
      value.kind = Kind::boolean;
      value.boolean = boolean->get();
    } else {
      value.kind = Kind::date;
      value.string = std::string(value.written);
    }
    return value;
  }

 private:
  const Source& source_;
  TextIndex index_;
};

toml::table parse_toml(const Source& source) {
  try {
    return toml::parse(std::string_view(source.text));
  } catch (const toml::parse_error& error) {
    std::string_view reason = error.description();
    constexpr std::string_view kLead = "Error while parsing ";
    if (reason.starts_with(kLead)) {
      reason.remove_prefix(kLead.size());
    }
    fail({&source, error.source().begin.line},
         fmt::format("this is not valid TOML; {}", sanitize(reason)));
  }
}

Value parse_source(Document& document, std::string name, std::string_view text) {
  if (text.size() > kFileLimit_bytes) {
    throw Error(ErrorKind::usage,
                fmt::format("{}: is larger than the limit of {} bytes for a configuration",
                            sanitize(name), kFileLimit_bytes));
  }
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  const Source& source =
      document.sources.emplace_back(Source{std::move(name), std::string(text), false});
  check_text(source);
  return Converter(source).convert(parse_toml(source), "");
}

// Puts `over` on top of `base`: tables merge key by key, any other value replaces that of `base`.
void merge(Value& base, Value over) {
  if (base.kind != Kind::table || over.kind != Kind::table) {
    base = std::move(over);
    return;
  }
  base.place = over.place;
  base.written = over.written;
  for (auto& [key, value] : over.keys) {
    auto& slot = base.keys[key];
    if (slot) {
      merge(*slot, std::move(*value));
    } else {
      slot = std::move(value);
    }
  }
}

class Loader {
 public:
  Loader(Document& document, const std::filesystem::path& shipped)
      : document_(document), shipped_(shipped) {}

  Value load(const std::filesystem::path& file) {
    const std::string content = read_file(file, kFileLimit_bytes, ErrorKind::usage);
    document_.files.push_back(file);
    chain_.push_back(file.filename().string());
    Value value = parse(file, content);
    const auto found = value.keys.find("extends");
    if (found == value.keys.end()) {
      return value;
    }
    const std::unique_ptr<Value> extends = std::move(found->second);
    value.keys.erase(found);
    Value base = load(find_extended(*extends, file));
    merge(base, std::move(value));
    return base;
  }

 private:
  Value parse(const std::filesystem::path& file, const std::string& content) {
    try {
      return parse_source(document_, file.string(), content);
    } catch (const Error& error) {
      if (chain_.size() < 2) {
        throw;
      }
      throw Error(error.kind(), fmt::format("{} ({} extends this file)", error.what(),
                                            sanitize(chain_[chain_.size() - 2])));
    }
  }

  std::filesystem::path find_extended(const Value& extends,
                                      const std::filesystem::path& file) const {
    constexpr std::string_view kMust =
        "it must be the name of a file in the same folder or of a shipped one, without .toml: "
        "letters, digits, _ - .";
    const std::string& name = extends.string;
    if (extends.kind != Kind::string) {
      fail(extends.place, fmt::format("extends is {}; {}", extends.describe_with_type(), kMust));
    }
    const bool plain =
        !name.empty() && name.front() != '.' &&
        std::all_of(name.begin(), name.end(), [](char c) { return is_bare_letter(c) || c == '.'; });
    if (!plain) {
      fail(extends.place, fmt::format("extends is {}; {}", extends.describe(), kMust));
    }
    const std::string file_name = name + ".toml";
    const std::string chain = fmt::format("{} -> {}", join(chain_, " -> "), file_name);
    if (std::find(chain_.begin(), chain_.end(), file_name) != chain_.end()) {
      fail(extends.place, fmt::format("extends is {}; the files extend each other in a circle: {}",
                                      extends.describe(), chain));
    }
    if (chain_.size() > kExtendsLimit) {
      fail(extends.place,
           fmt::format("extends is {}; at most {} files may be extended in a row: {}",
                       extends.describe(), kExtendsLimit, chain));
    }
    const std::filesystem::path folder = file.parent_path();
    std::error_code ignored;  // a file that exists and cannot be read is reported when it is read
    if (std::filesystem::exists(folder / file_name, ignored)) {
      return folder / file_name;
    }
    if (!shipped_.empty() && std::filesystem::exists(shipped_ / file_name, ignored)) {
      return shipped_ / file_name;
    }
    std::vector<std::string> known = list_siblings(folder);
    if (!shipped_.empty() && !std::filesystem::equivalent(folder, shipped_, ignored)) {
      std::ranges::copy(list_siblings(shipped_), std::back_inserter(known));
    }
    fail(extends.place, describe_unknown("file to extend", name, known));
  }

  std::vector<std::string> list_siblings(const std::filesystem::path& folder) const {
    std::vector<std::string> names;
    std::error_code error;
    std::filesystem::directory_iterator entries(folder.empty() ? "." : folder, error);
    for (const auto& entry : entries) {
      const std::string own = entry.path().filename().string();
      if (entry.path().extension() == ".toml" &&
          std::find(chain_.begin(), chain_.end(), own) == chain_.end()) {
        names.push_back(sanitize(entry.path().stem().string()));
      }
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  Document& document_;
  const std::filesystem::path& shipped_;
  std::vector<std::string> chain_;  // names of the files that are being loaded, the first first
};

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string_view::npos
             ? std::string_view()
             : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

bool is_bare_word(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return is_bare_letter(c) || c == '.' || c == '/';
  });
}

Value parse_override_value(Document& document, std::string name, std::string_view key,
                           std::string_view text) {
  Source& source = document.sources.emplace_back(Source{std::move(name), "", true});
  constexpr std::string_view kPrefix = "v = ";  // TOML has no documents of one value
  source.text = fmt::format("{}{}", kPrefix, text);
  const Place place{&source, 1};
  if (std::any_of(text.begin(), text.end(),
                  [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; })) {
    fail(place, "the value has a control character in it");
  }
  std::optional<toml::table> table;
  if (!text.empty()) {
    check_text(source);
    try {
      table = toml::parse(std::string_view(source.text));
    } catch (const toml::parse_error&) {
      table.reset();  // the text may still be a bare word
    }
  }
  if (table) {
    return Converter(source).convert(*table->get("v"), std::string(key));
  }
  if (!is_bare_word(text)) {
    fail(place,
         fmt::format("'{}' is neither a TOML value nor a word of letters, digits, _ - . and /; "
                     "put text in quotes, as in --set '{}=\"two words\"'",
                     shorten(text), key));
  }
  Value value;
  value.kind = Kind::string;
  value.place = place;
  value.string = std::string(text);
  value.written = std::string_view(source.text).substr(kPrefix.size());
  return value;
}

void apply_override(Document& document, std::string_view text) {
  const std::string name = fmt::format("--set {}", shorten(text));
  const std::size_t equals = text.find('=');
  const std::string_view key = trim(text.substr(0, equals));
  const std::vector<std::string> parts = split(key, '.');
  if (equals == std::string_view::npos || !std::all_of(parts.begin(), parts.end(), is_bare_key) ||
      parts.size() > kDepthLimit || text.size() > kFileLimit_bytes) {
    throw Error(ErrorKind::usage, fmt::format("{}: {}; {}", name,
                                              equals == std::string_view::npos
                                                  ? "there is no '=' in it"
                                                  : "there is no usable key before the '='",
                                              kOverrideExample));
  }
  Value value = parse_override_value(document, name, key, trim(text.substr(equals + 1)));
  if (key == "extends") {
    fail(value.place, "extends cannot be overridden; name another file instead");
  }
  Value* table = &document.root;
  std::string path;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    path = join_path(path, parts[i]);
    auto& slot = table->keys[parts[i]];
    if (!slot) {
      slot = std::make_unique<Value>();
      slot->place = value.place;
    }
    if (slot->kind != Kind::table) {
      fail(value.place, fmt::format("{} is {} ({}), not a table; nothing below it can be set", path,
                                    slot->describe_with_type(), slot->place.describe()));
    }
    table = slot.get();
  }
  auto& slot = table->keys[parts.back()];
  if (!slot) {
    slot = std::make_unique<Value>(std::move(value));
  } else {
    const Place place = slot->place;
    const bool both_tables = slot->kind == Kind::table && value.kind == Kind::table;
    merge(*slot, std::move(value));
    slot->place = both_tables ? place : slot->place;  // a table that gets a key keeps its place
  }
}

}  // namespace

std::string Place::describe() const {
  return source->is_override ? source->name : fmt::format("{}:{}", sanitize(source->name), line);
}

std::string Value::describe() const {
  switch (kind) {
    case Kind::table:
      return "a table";
    case Kind::array:
      return written.size() > 60 || written.find('\n') != std::string_view::npos
                 ? fmt::format("an array of length {}", items.size())
                 : sanitize(written);
    default:
      return shorten(written);
  }
}

std::string Value::describe_with_type() const {
  switch (kind) {
    case Kind::string:
      return describe() + ", a string";
    case Kind::integer:
      return describe() + ", an integer";
    case Kind::number:
      return describe() + ", a floating-point number";
    case Kind::boolean:
      return describe() + ", a boolean";
    case Kind::date:
      return describe() + ", a date or time";
    case Kind::array:
      return describe().starts_with('[') ? describe() + ", an array" : describe();
    case Kind::table:
      break;
  }
  return describe();
}

std::string shorten(std::string_view text) {
  constexpr std::size_t kShown_bytes = 60;
  if (text.size() <= kShown_bytes) {
    return sanitize(text);
  }
  std::size_t end = kShown_bytes;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) {
    --end;  // do not cut inside a character
  }
  return sanitize(text.substr(0, end)) + "...";
}

bool is_bare_key(std::string_view key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), is_bare_letter);
}

std::string join_path(std::string_view path, std::string_view key) {
  const std::string shown = is_bare_key(key) ? shorten(key) : fmt::format("\"{}\"", shorten(key));
  return path.empty() ? shown : fmt::format("{}.{}", path, shown);
}

void fail(const Place& place, std::string_view message) {
  throw Error(ErrorKind::usage, fmt::format("{}: {}", place.describe(), message));
}

std::shared_ptr<const Document> load_document(const std::filesystem::path& file,
                                              std::span<const std::string> overrides,
                                              const std::filesystem::path& shipped) {
  const auto document = std::make_shared<Document>();
  document->file = file;
  document->root = Loader(*document, shipped).load(file);
  for (const std::string& text : overrides) {
    apply_override(*document, text);
  }
  return document;
}

std::shared_ptr<const Document> parse_document(std::string_view toml, const std::string& name,
                                               std::span<const std::string> overrides) {
  const auto document = std::make_shared<Document>();
  document->file = name;
  document->root = parse_source(*document, name, toml);
  const auto extends = document->root.keys.find("extends");
  if (extends != document->root.keys.end()) {
    fail(extends->second->place,
         fmt::format("extends is {}; only a file in a folder can extend another",
                     extends->second->describe()));
  }
  for (const std::string& text : overrides) {
    apply_override(*document, text);
  }
  return document;
}

}  // namespace armwright::config
