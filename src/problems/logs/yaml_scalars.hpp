// Reads YAML as a flat list of scalars.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace armwright {

struct YamlScalar {
  std::string text;
  std::size_t line = 0;
};
// The scalars of a file by their keys, joined with dots. The elements of a list have numbers from 0
// as keys.
using YamlScalars = std::map<std::string, YamlScalar>;

// Returns the scalars of a text, which is read event by event, so that neither depth nor aliases cost
// memory. `file` is its name in messages, and `advice` what to do if it has more than `most` values.
// Throws Error{bad_data} with file and line for a text that is no YAML, aliases, keys that stand there
// twice, and more than one document.
YamlScalars read_yaml_scalars(std::string_view text, const std::string& file, std::size_t most,
                              const std::string& advice);

}  // namespace armwright
