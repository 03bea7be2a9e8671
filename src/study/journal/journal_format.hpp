// The bytes of a journal (study/journal.hpp), little-endian throughout; doubles are stored as their
// bits, so that NaN survives.
//
//   file       = "AWJRNL01" record*
//   record     = u32 payload length | u32 CRC-32 of the payload | payload
//   payload    = evaluation | evaluation with Jacobian | end
//   evaluation = u8 1 | u8 clipped | u8 role | u8 status | i32 failed_cases | u64 index
//                | u64 generation
//                | text set | list numbers (u64) | list x | text reason
//                | list objectives | list constraint_values | list case_errors | list metrics
//                | list residuals (empty unless the optimizer uses them)
//   evaluation with Jacobian = u8 3 | as above | list jacobian (a row a residual, row after row)
//   end        = u8 2 | u64 evaluations | text reason
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
inline constexpr std::size_t kFrameBytes = 8;  // length and checksum
inline constexpr std::size_t kProbeBytes =
    13;  // what could_begin_payload() wants to see; no payload is shorter
// 8 million numbers, far above any candidate's. A longer record is refused when written and taken
// for damage when read.
inline constexpr std::size_t kMaxPayloadBytes = std::size_t{64} << 20;

using Record = std::variant<EvaluationRecord, EndRecord>;

// Appends the framed record. Error{bad_data}, with `buffer` unchanged, if it is larger than
// kMaxPayloadBytes.
void encode(const EvaluationRecord& record, std::string& buffer);
void encode(const EndRecord& record, std::string& buffer);

struct Frame {
  std::uint32_t payload_bytes = 0;
  std::uint32_t checksum = 0;
};
Frame decode_frame(std::string_view bytes);  // the first kFrameBytes

// The bytes of the whole records at the beginning of `records`, whose last one may be cut short.
std::size_t count_whole_record_bytes(std::string_view records);

// A cheap test that nearly no place fails to fail unless a record begins there: `probe` is the
// payload's first kProbeBytes.
bool could_begin_payload(std::string_view probe, std::uint32_t payload_bytes);

// The bytes are exactly one payload: each list within it has the length that it states, and nothing
// is left over. Looks at a few places only, however long they are.
bool is_payload(std::string_view bytes);

// Nothing if the bytes are no payload. Never allocates more than a small multiple of their own
// size.
std::optional<Record> decode_payload(std::string_view payload);

}  // namespace armwright::journal_format
