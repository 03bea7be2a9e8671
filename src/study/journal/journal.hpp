// The journal: an append-only file with one checksummed record a candidate. It is the truth of a
// run; everything else is derived.
//
// Format (little-endian): the 8 bytes "AWJRNL01", then records of
//   u32 payload length | u32 CRC-32 of the payload | payload
// Payloads are self-describing: a record type byte and its fields (journal_format.hpp). Numbers are
// stored as their bits.
//
// Durability: append() hands a record over; it reaches the operating system at the latest 10 ms
// later or at flush(), and the disk (fdatasync) at least once a second and at close(). Appending is
// thread-safe; with several threads records lie in the order in which evaluations finished, and
// their index tells their place.
//
// Reading: a record cut short or damaged at the very end of the file is what a kill or power cut
// leaves; it is cut off, its bytes kept in "journal.torn-N", and reported. Damage with intact
// records after it is an Error{bad_data} that names the offset.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "study/journal/evaluation_record.hpp"
#include "study/journal/recorded_evaluations.hpp"

namespace armwright {

// The run has come to its end; written once, last. `reason` is "budget" or
// "optimizer finished".
struct EndRecord {
  std::string reason;
  std::uint64_t evaluations = 0;
};

struct JournalContent {
  RecordedEvaluations training;
  std::vector<EvaluationRecord> judgements;  // validation and test, in the order written
  bool ended = false;
  EndRecord end;
  std::uint64_t torn_bytes = 0;  // what was cut off the end, 0 if nothing
};

class Journal {
 public:
  // Opens for appending, creating the file if there is none; what it holds goes to `content`. A
  // torn end is removed (see above). The caller holds the run's lock. Error{io} or Error{bad_data}
  // names the file.
  Journal(const std::filesystem::path& file, JournalContent& content);
  ~Journal();  // closes; an error that close() would report is lost
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  void append(const EvaluationRecord& record);
  void append(const EndRecord& record);
  // Everything appended so far has reached the operating system. Throws the first write error since
  // the last call, if any.
  void flush();
  // flush(), fdatasync and close.
  void close();

 private:
  class Writer;
  std::unique_ptr<Writer> writer_;
};

// Reads without changing anything (for show, export and tests): a torn end is left alone and
// counted.
JournalContent read_journal(const std::filesystem::path& file);

}  // namespace armwright
