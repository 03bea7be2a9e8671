#include "problems/logs/yaml_scalars.hpp"

#include <fmt/format.h>
#include <yaml.h>

#include <new>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr int kMostLevels = 32;
constexpr std::size_t kLongestKey = 1000;  // with the keys above it

class YamlReader {
 public:
  YamlReader(std::string_view text, const std::string& file, std::size_t most,
             const std::string& advice)
      : file_(file), most_(most), advice_(advice) {
    if (yaml_parser_initialize(&parser_) == 0) {
      throw std::bad_alloc();
    }
    yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()),
                                 text.size());
  }
  ~YamlReader() {
    yaml_event_delete(&event_);
    yaml_parser_delete(&parser_);
  }
  YamlReader(const YamlReader&) = delete;
  YamlReader& operator=(const YamlReader&) = delete;

  YamlScalars read() {
    next();  // the start of the stream
    next();
    if (event_.type != YAML_STREAM_END_EVENT) {
      next();
      read_node("", 0);
      next();  // the end of the document
      next();
      if (event_.type != YAML_STREAM_END_EVENT) {
        refuse("a second document begins; ROS 2 reads one per file: leave one of them");
      }
    }
    return std::move(scalars_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}:{}: {}", file_, event_.start_mark.line + 1, what));
  }

  void next() {
    check_reading();
    yaml_event_delete(&event_);
    if (yaml_parser_parse(&parser_, &event_) == 0) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}:{}: it is not YAML: {}", file_, parser_.problem_mark.line + 1,
                              parser_.problem == nullptr ? "it cannot be read" : parser_.problem));
    }
    if (event_.type == YAML_ALIAS_EVENT) {
      refuse("an alias (*NAME); write the values out");
    }
  }

  std::string get_text() const {
    return {reinterpret_cast<const char*>(event_.data.scalar.value), event_.data.scalar.length};
  }

  // Reads the node that begins with the present event. Its last event is the present one then.
  void read_node(const std::string& key, int level) {
    if (level > kMostLevels) {
      refuse(fmt::format("it is nested deeper than {} levels", kMostLevels));
    }
    const auto join_key = [&](const std::string& part) {
      return key.empty() ? part : key + "." + part;
    };
    switch (event_.type) {
      case YAML_SCALAR_EVENT:
        add(key);
        return;
      case YAML_SEQUENCE_START_EVENT:
        next();
        for (std::size_t i = 0; event_.type != YAML_SEQUENCE_END_EVENT; ++i, next()) {
          read_node(join_key(std::to_string(i)), level + 1);
        }
        return;
      case YAML_MAPPING_START_EVENT:
        next();
        for (; event_.type != YAML_MAPPING_END_EVENT; next()) {
          if (event_.type != YAML_SCALAR_EVENT) {
            refuse("a key is a list or a map; it must be a word");
          }
          const std::string own = join_key(get_text());
          next();
          read_node(own, level + 1);
        }
        return;
      default:
        refuse("it has no value");
    }
  }

  void add(const std::string& key) {
    if (key.size() > kLongestKey || scalars_.size() == most_) {
      refuse(fmt::format("a key has more than {} characters, or the file more than {} values; {}",
                         kLongestKey, most_, advice_));
    }
    const auto [place, added] = scalars_.try_emplace(key);
    if (!added) {
      refuse(fmt::format("'{}' stands there twice (line {} too); leave one", sanitize(key),
                         place->second.line));
    }
    place->second = {get_text(), event_.start_mark.line + 1};
  }

  const std::string& file_;
  std::size_t most_;
  const std::string& advice_;
  yaml_parser_t parser_{};
  yaml_event_t event_{};
  YamlScalars scalars_;
};

}  // namespace

YamlScalars read_yaml_scalars(std::string_view text, const std::string& file, std::size_t most,
                              const std::string& advice) {
  return YamlReader(text, file, most, advice).read();
}

}  // namespace armwright
