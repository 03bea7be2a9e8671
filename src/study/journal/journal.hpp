// The journal of a run: an append-only file with one checksummed record per evaluation. All other
// results of a run are derived from it.
//
// Format (little-endian): the 8 bytes "AWJRNL01", then records of
//   u32 payload length | u32 CRC-32 of the payload | payload
// A payload is a byte for its type and its fields (journal_format.hpp). Numbers are stored as their
// bits.
//
// Durability: append() hands a record over. It reaches the operating system after at most 10 ms or
// at flush(), and the disk (fdatasync) at least once per second and at close(). Appending is
// thread-safe. With several threads the records are in the order of completion, and the index of a
// record is its place in the order of the optimizer.
//
// Reading: a kill or a power cut leaves a record that is cut short or damaged at the very end of
// the file. Such an end is cut off and reported, and its bytes are kept in "journal.torn-N". Damage
// with intact records behind it is an Error{bad_data} that names the offset.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "study/journal/recorded_evaluations.hpp"

namespace armwright {

// The last record of a run that has ended.
struct EndRecord {
  std::string reason;  // "budget" or "optimizer finished"
  std::uint64_t evaluations = 0;
};

struct JournalContent {
  RecordedEvaluations training;
  std::vector<EvaluationRecord> judgements;  // validation and test, in the order written
  bool ended = false;
  EndRecord end;                   // valid if `ended`
  std::uint64_t intact_bytes = 0;  // up to the end of the last intact record
  std::uint64_t torn_bytes = 0;    // behind that
};

class Journal {
 public:
  // Opens the file for appending, and creates it if there is none. Reads its records to `content`
  // and cuts off a torn end (see above). The caller must hold the run's lock. Throws Error{io} or
  // Error{bad_data}, which name the file.
  Journal(const std::filesystem::path& file, JournalContent& content);
  ~Journal();  // closes; an error that close() would throw is lost
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // Throw Error{bad_data} if the record is too large for the journal, Error{io} if an earlier write
  // has failed, and std::logic_error after close() or after an end record.
  void append(const EvaluationRecord& record);
  void append(const EndRecord& record);
  // Writes everything appended so far to the operating system. Throws Error{io} if any write has
  // failed.
  void flush();
  // Flushes, syncs to the disk and closes the file. Throws Error{io} as flush().
  void close();

 private:
  class Writer;
  std::unique_ptr<Writer> writer_;
};

// Reads a journal without changing it: a torn end is counted and not cut off. Throws Error{io} or
// Error{bad_data}, which name the file.
JournalContent read_journal(const std::filesystem::path& file);

}  // namespace armwright
