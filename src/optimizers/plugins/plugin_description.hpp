// What a plugin in a shared library says of itself (include/armwright/plugin.h), read with distrust
// in the process that has opened it, and as bytes for the one that must not.
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

// Why a library is no plugin: the end of a sentence that begins with its name.
class PluginRefusal : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct PluginDescription {
  std::string summary;
  std::string source;
  std::uint32_t capabilities = 0;
  std::vector<OptionSpec> options;
};

// To be called in the process that is to call it. The library stays open: what it has started may
// still run. Throws PluginRefusal.
const struct armwright_plugin& open_plugin(const std::filesystem::path& file);

// `own_options`: names that are taken. The plugin's own name is checked and left: the user's word
// for it counts. Throws PluginRefusal.
PluginDescription describe_plugin(const struct armwright_plugin& plugin,
                                  std::span<const std::string> own_options);

void pack(const PluginDescription& description, PacketWriter& writer);
PluginDescription unpack_description(PacketReader& reader);

}  // namespace armwright
