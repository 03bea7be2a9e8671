#include "problems/logs/decompression.hpp"

#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <memory>
#include <vector>

#include "base/error.hpp"
#include "base/read_limit.hpp"

namespace armwright {
namespace {

constexpr std::size_t kPiece_bytes = std::size_t{64} << 10;

[[noreturn]] void refuse_frames(const std::string& where, const std::string& what) {
  throw Error(ErrorKind::bad_data, fmt::format("{}: {}", where, what));
}

void append_piece(std::string& content, const std::vector<char>& piece, std::size_t size,
                  std::size_t limit_bytes, const std::string& where) {
  content.append(piece.data(), size);
  if (content.size() > limit_bytes) {
    refuse_frames(where,
                  fmt::format("has more than {} bytes when it is decompressed", limit_bytes));
  }
  check_reading();
}

struct FreeZstd {
  void operator()(ZSTD_DStream* stream) const { ZSTD_freeDStream(stream); }
};
struct FreeLz4 {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

}  // namespace

bool is_zstd(std::string_view bytes) {
  return bytes.starts_with("\x28\xB5\x2F\xFD");
}

std::string decompress_zstd(std::string_view bytes, std::size_t limit_bytes,
                            const std::string& where) {
  // A bag may have a frame per message: one stream per thread serves all.
  thread_local const std::unique_ptr<ZSTD_DStream, FreeZstd> stream(ZSTD_createDStream());
  if (!stream || ZSTD_isError(ZSTD_initDStream(stream.get()))) {
    throw std::bad_alloc();
  }
  std::string content;
  std::vector<char> piece(kPiece_bytes);
  ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
  std::size_t left = 1;
  while (true) {
    ZSTD_outBuffer output{piece.data(), piece.size(), 0};
    left = ZSTD_decompressStream(stream.get(), &output, &input);
    if (ZSTD_isError(left)) {
      refuse_frames(where, fmt::format("zstd cannot decompress it at byte {}: {}", input.pos,
                                       ZSTD_getErrorName(left)));
    }
    append_piece(content, piece, output.pos, limit_bytes, where);
    if (input.pos == input.size && output.pos < output.size) {
      break;
    }
  }
  if (left != 0) {
    refuse_frames(where, fmt::format("ends at byte {}, within a frame of zstd: it was cut off",
                                     bytes.size()));
  }
  return content;
}

std::string decompress_lz4(std::string_view bytes, std::size_t limit_bytes,
                           const std::string& where) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) {
    throw std::bad_alloc();
  }
  const std::unique_ptr<LZ4F_dctx, FreeLz4> owner(context);
  std::string content;
  std::vector<char> piece(kPiece_bytes);
  std::size_t done = 0;
  bool is_whole = bytes.empty();
  while (!(is_whole && done == bytes.size())) {
    std::size_t written = piece.size();
    std::size_t taken = bytes.size() - done;
    const std::size_t left =
        LZ4F_decompress(context, piece.data(), &written, bytes.data() + done, &taken, nullptr);
    if (LZ4F_isError(left)) {
      refuse_frames(where, fmt::format("lz4 cannot decompress it at byte {}: {}", done,
                                       LZ4F_getErrorName(left)));
    }
    if (taken == 0 && written == 0) {
      refuse_frames(where, fmt::format("ends at byte {}, within a frame of lz4: it was cut off",
                                       bytes.size()));
    }
    done += taken;
    is_whole = left == 0;
    append_piece(content, piece, written, limit_bytes, where);
  }
  return content;
}

}  // namespace armwright
