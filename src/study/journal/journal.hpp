// The journal of a run: an append-only file with one checksummed record per evaluation. All other
// results of a run are derived from it.
//
// Format (little-endian): the 8 bytes "AWJRNL01", then records of
//   u32 payload length | u32 CRC-32 of the payload | payload
// A payload has one byte for its type, then its fields (journal_format.hpp). A floating-point
// number is stored as its 64 bits, so reading gives the same number.
//
// Durability: append() puts a record into a buffer in memory. The buffer is written to the
// operating system after at most 10 ms and at flush(), and synced to the disk (fdatasync) once per
// second and at close(). A kill can therefore lose the last 10 ms, and a power cut the last second.
//
// Order: the file has the records in the order of the calls of append(). Threads append evaluations
// as they finish, so this order can differ from the order of the optimizer's requests, which
// EvaluationRecord::index gives.
//
// Torn end: a kill or a power cut can leave an incomplete or damaged record at the end of the file.
// The constructor cuts it off, reports its size and keeps its bytes in "journal.torn-N". If intact
// records follow a damaged one, reading throws Error{bad_data} with the offset of the damage.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/folder.hpp"
#include "study/journal/recorded_evaluations.hpp"

namespace armwright {

// The last record of a run that has ended, unless the run is continued.
struct EndRecord {
  std::string reason;             // "budget" or "optimizer finished"
  std::uint64_t evaluations = 0;  // training evaluations of the whole run, over all its starts
};

// The decision vectors that the optimizer recommended after the budget had ended. A run has at most
// one such record. A resumed run takes them from here, because the optimizer may be too slow to
// recommend them again within its time.
struct LateRecommendations {
  std::uint64_t count = 0;
  std::vector<double> x;  // all vectors, one after the other
};

// Says that the run goes on with a larger budget. The records before it stay: evaluations and
// judgements count as before, but an end and late recommendations are those of the smaller budget.
struct ContinueRecord {
  std::uint64_t budget = 0;       // the larger one, in training cases
  std::uint64_t evaluations = 0;  // training evaluations that were recorded before
};

// The records of a journal.
struct JournalContent {
  RecordedEvaluations training;
  std::vector<EvaluationRecord> judgements;  // validation and test, in the order written
  std::optional<LateRecommendations> late;   // behind the last ContinueRecord
  bool ended = false;                        // likewise
  EndRecord end;                             // valid if `ended`
  std::uint64_t intact_bytes = 0;            // up to the end of the last intact record
  std::uint64_t torn_bytes = 0;              // the size of the torn end behind it
};

// A journal is open for appending from its construction until close(). append() and flush() are
// thread-safe. close() and the destructor must not run while another thread uses the journal.
class Journal {
 public:
  // Opens the file `name` of the folder for appending, and creates it if it does not exist. Stores
  // its records in `content`. Cuts off a torn end. The caller must hold the run's lock
  // (run_lock.hpp). Throws Error{io} if the file cannot be read or written, and Error{bad_data} if
  // it is damaged, no journal, no regular file, or has a second name. The messages name the file.
  Journal(const Folder& folder, const std::string& name, JournalContent& content);
  // Does the same. Follows links on the way to the file's folder.
  Journal(const std::filesystem::path& file, JournalContent& content);
  ~Journal();  // closes the file; ignores errors, which close() would throw
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  // Append a record. Throw Error{bad_data} if the record is too large for the journal, Error{io} if
  // a write or a sync has failed since the opening, and std::logic_error after close() or after an
  // end record. Only a ContinueRecord may follow an end; it is on the disk when append() returns.
  void append(const EvaluationRecord& record);
  void append(const LateRecommendations& record);
  void append(const EndRecord& record);
  void append(const ContinueRecord& record);
  // Writes all appended records to the operating system. Throws Error{io} if a write or a sync has
  // failed since the opening.
  void flush();
  // Writes all appended records, syncs them to the disk and closes the file. Throws Error{io} as
  // flush() does. A second call does nothing.
  void close();

 private:
  class Writer;
  std::unique_ptr<Writer> writer_;
};

// Reads a journal and leaves the file as it is: it only counts the bytes of a torn end. Throws
// Error{io} if the file cannot be read, and Error{bad_data} if it is damaged or is no journal. The
// messages name the file.
JournalContent read_journal(const std::filesystem::path& file);

}  // namespace armwright
