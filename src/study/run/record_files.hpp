// The JSON files of a run's and a cell's folder: how large they may be, and the version of the
// manifest. Whoever reads one checks both before he believes anything in it.
#pragma once

#include <cstddef>

namespace armwright {

inline constexpr int kManifestFormat = 1;

inline constexpr std::size_t kManifestLimit_bytes = std::size_t{16} << 20;
inline constexpr std::size_t kResultLimit_bytes = std::size_t{256} << 20;
inline constexpr std::size_t kCellLimit_bytes = std::size_t{64} << 20;

}  // namespace armwright
