// Reads the records of a journal (journal.hpp) through a buffer, because a journal may be larger
// than the memory, and tells a torn end from damage. Only .cpp files include this header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/file_descriptor.hpp"
#include "study/journal/journal_format.hpp"

namespace armwright {

// A window onto the bytes of a journal. Not thread-safe.
class JournalWindow {
 public:
  // Reads from `fd`, which stays the caller's. Throws Error{io} if it is no regular file.
  JournalWindow(int fd, std::filesystem::path file);

  const std::filesystem::path& file() const { return file_; }
  // Returns the size at construction. Bytes that another process appends later are not read.
  std::uint64_t size() const { return size_; }
  // Treats `offset` as the end of the file from now on: the caller may cut off a torn end.
  void end_at(std::uint64_t offset);
  std::uint64_t bytes_from(std::uint64_t offset) const { return size_ - offset; }
  // Returns the first offset from `offset` on that does not lie in a hole of the file; the size if
  // there is none.
  std::uint64_t skip_hole(std::uint64_t offset) const;
  // Returns bytes that must lie within the file. They are valid until the next call. Throws
  // Error{io} if they cannot be read.
  std::string_view view(std::uint64_t offset, std::size_t length);

  // Behind damage any offset may look like the start of a record, and in a prepared file each of
  // them may look as long as the rest. A search for intact records therefore counts the bytes that
  // it read without finding one, and gives up when they are more than any accident explains.
  void begin_search() { misread_bytes_ = 0; }
  void count_misread(std::uint64_t bytes) { misread_bytes_ += bytes; }
  bool has_given_up() const;

 private:
  void fill(std::uint64_t offset, std::size_t length);

  int fd_;
  std::filesystem::path file_;
  std::uint64_t size_ = 0;
  std::uint64_t misread_bytes_ = 0;
  std::uint64_t begin_ = 0;
  std::string buffer_;
};

// The result of reading a record at some offset.
struct RecordAttempt {
  std::optional<journal_format::Record> record = std::nullopt;
  std::uint64_t end = 0;   // the offset behind the record
  const char* fault = "";  // why there is no record
};
// Throws Error{io}.
RecordAttempt read_record(JournalWindow& window, std::uint64_t offset);

// Returns the offset of the next intact record behind `offset`, or nothing if there is none or the
// search has been given up. Throws Error{io}.
std::optional<std::uint64_t> find_intact_record(JournalWindow& window, std::uint64_t offset);

// Says in one clause why a search was given up.
inline constexpr const char* kGivenUp =
    "too many places behind it look like long records and are none, as no accident leaves them: "
    "the search for intact ones was given up";

// Returns a sentence that tells the user what to do about a damaged journal.
std::string advise_on_damage(const std::filesystem::path& journal);

// Reads a whole journal from `descriptor`, which is open for reading and goes to the content. Does
// not change the file. Throws Error{io} if it cannot be read or is no regular file, and
// Error{bad_data} if it is not a journal or is damaged before its end.
JournalContent scan_journal(FileDescriptor descriptor, const std::filesystem::path& file);

}  // namespace armwright
