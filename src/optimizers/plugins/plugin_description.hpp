// The description that a plugin in a shared library gives of itself (include/armwright/plugin.h).
// The process that has opened the library checks every field; the parent process gets the
// description as bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "armwright/plugin.h"
#include "optimizers/interface/optimizer.hpp"
#include "process/packet.hpp"

namespace armwright {

// Says why a library is no plugin. The text completes a sentence that begins with the library's
// name.
class PluginRefusal : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct PluginDescription {
  std::string name;
  std::string summary;
  std::string source;
  std::uint32_t capabilities = 0;
  Requirements requirements;
  std::vector<OptionSpec> options;
};

// Opens a plugin. Call this in the process that will call the plugin. The library stays open,
// because its threads may still run. Throws PluginRefusal.
const struct armwright_plugin& open_plugin(const std::filesystem::path& file);

// Reads and checks the description. `own_options` are names that the plugin may not use. The
// plugin's own name is for tables; everywhere else the name that the user typed counts. Throws
// PluginRefusal.
PluginDescription describe_plugin(const struct armwright_plugin& plugin,
                                  std::span<const std::string> own_options);

void pack(const PluginDescription& description, PacketWriter& writer);
PluginDescription unpack_description(PacketReader& reader);

}  // namespace armwright
