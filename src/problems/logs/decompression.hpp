// Decompresses what bags have: frames of Zstandard (RFC 8878) and of LZ4.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace armwright {

bool is_zstd(std::string_view bytes);

// Return the content of one or more frames. `where` is the place of the frames, for messages. They
// throw Error{bad_data} "WHERE: ..." for damaged or incomplete frames and for more than
// `limit_bytes`. The memory that they take grows with what is decompressed, not with what the
// frames claim.
std::string decompress_zstd(std::string_view bytes, std::size_t limit_bytes,
                            const std::string& where);
std::string decompress_lz4(std::string_view bytes, std::size_t limit_bytes,
                           const std::string& where);

}  // namespace armwright
