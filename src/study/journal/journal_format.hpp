// The bytes of a journal (journal.hpp), little-endian throughout. Doubles are stored as their bits,
// so NaN survives.
//
//   file       = "AWJRNL01" record*
//   record     = u32 payload length | u32 CRC-32 of the payload | payload
//   payload    = evaluation | evaluation with Jacobian | late recommendations | end
//                | evaluation with proposal | evaluation with Jacobian and proposal | continue
//   evaluation = u8 1 | u8 clipped | u8 role | u8 status | i32 failed_cases | u64 index
//                | u64 generation
//                | text set | list numbers (u64) | list x | text reason
//                | list objectives | list constraint_values | list case_errors | list metrics
//                | list residuals (empty unless the optimizer uses them)
//   evaluation with Jacobian = u8 3 | as above | list jacobian (one row per residual, row by row)
//   evaluation with proposal = u8 5 | as evaluation | list proposed (as the optimizer asked)
//   evaluation with Jacobian and proposal = u8 6 | as evaluation with Jacobian | list proposed
//   late recommendations = u8 4 | u64 count | list x (one vector after the other)
//   end        = u8 2 | u64 evaluations | text reason
//   continue   = u8 7 | u64 budget | u64 evaluations
//   text       = u32 length | bytes          list = u32 count | 8 bytes each
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "study/journal/journal.hpp"

namespace armwright::journal_format {

inline constexpr std::string_view kMagic = "AWJRNL01";
inline constexpr std::size_t kFrameBytes = 8;   // length and checksum
inline constexpr std::size_t kProbeBytes = 13;  // of could_begin_payload(); the shortest payload
// 8 million numbers, far more than any candidate has. A longer record is refused when it is
// written, and counts as damage when it is read.
inline constexpr std::size_t kMaxPayloadBytes = std::size_t{64} << 20;

using Record = std::variant<EvaluationRecord, LateRecommendations, EndRecord, ContinueRecord>;

// Appends the record with its frame to `buffer`. Throws Error{bad_data} if the payload is larger
// than kMaxPayloadBytes; `buffer` is unchanged then.
void encode(const EvaluationRecord& record, std::string& buffer);
void encode(const LateRecommendations& record, std::string& buffer);
void encode(const EndRecord& record, std::string& buffer);
void encode(const ContinueRecord& record, std::string& buffer);

struct Frame {
  std::uint32_t payload_bytes = 0;
  std::uint32_t checksum = 0;
};
Frame decode_frame(std::string_view bytes);  // exactly kFrameBytes

// Returns the size of the whole records at the beginning of `records`; the last record may be cut
// short.
std::size_t count_whole_record_bytes(std::string_view records);

// Returns false for nearly every place at which no payload begins; it is cheap. `probe` is the
// first kProbeBytes of the payload.
bool could_begin_payload(std::string_view probe, std::uint32_t payload_bytes);

// Returns whether the bytes are exactly one payload: every list in it has the stated length, and no
// byte is left over. The cost does not depend on the length of the lists.
bool is_payload(std::string_view bytes);

// Returns nothing if the bytes are no payload. Never allocates more than a small multiple of their
// size.
std::optional<Record> decode_payload(std::string_view payload);

}  // namespace armwright::journal_format
