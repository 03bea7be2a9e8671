#include "study/journal_reader.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/file_descriptor.hpp"
#include "base/hash.hpp"
#include "study/journal_format.hpp"

namespace armwright {
namespace {

using journal_format::Frame;
using journal_format::kFrameBytes;
using journal_format::kMagic;
using journal_format::kMaxPayloadBytes;
using journal_format::kProbeBytes;
using journal_format::Record;

// A file seen through a buffer: a journal may be larger than the memory its content needs twice
// over.
class Window {
 public:
  Window(int fd, const std::filesystem::path& file) : fd_(fd), file_(file) {
    struct stat status {};
    if (::fstat(fd, &status) != 0) {
      fail_io(file, "read it", errno);
    }
    if (!S_ISREG(status.st_mode)) {
      throw Error(ErrorKind::io,
                  fmt::format("{}: is not a regular file; a journal must be one", file.string()));
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }

  // At the time of opening: what another process appends meanwhile is not looked at.
  std::uint64_t size() const { return size_; }
  std::uint64_t bytes_from(std::uint64_t offset) const { return size_ - offset; }

  // Valid until the next call. The range lies within the file.
  std::string_view view(std::uint64_t offset, std::size_t length) {
    if (offset < begin_ || offset + length > begin_ + buffer_.size()) {
      fill(offset, length);
    }
    return std::string_view(buffer_).substr(offset - begin_, length);
  }

 private:
  void fill(std::uint64_t offset, std::size_t length) {
    constexpr std::uint64_t kChunkBytes = 1 << 20;
    buffer_.resize(std::min(std::max<std::uint64_t>(length, kChunkBytes), bytes_from(offset)));
    begin_ = offset;
    std::size_t filled = 0;
    while (filled < buffer_.size()) {
      const ssize_t got = ::pread(fd_, buffer_.data() + filled, buffer_.size() - filled,
                                  static_cast<off_t>(offset + filled));
      if (got < 0 && errno == EINTR) {
        continue;
      }
      if (got < 0) {
        fail_io(file_, "read it", errno);
      }
      if (got == 0) {
        throw Error(ErrorKind::io, fmt::format("{}: became shorter while it was read; is another "
                                               "process changing it?",
                                               file_.string()));
      }
      filled += static_cast<std::size_t>(got);
    }
  }

  int fd_;
  const std::filesystem::path& file_;
  std::uint64_t size_ = 0;
  std::uint64_t begin_ = 0;
  std::string buffer_;
};

struct Attempt {
  std::optional<Record> record = std::nullopt;
  std::uint64_t end = 0;   // of the record
  const char* fault = "";  // if there is none
};

Attempt read_record(Window& window, std::uint64_t offset) {
  if (window.bytes_from(offset) < kFrameBytes) {
    return {.fault = "its frame is cut short"};
  }
  const Frame frame = journal_format::decode_frame(window.view(offset, kFrameBytes));
  const std::uint64_t payload_at = offset + kFrameBytes;
  if (frame.payload_bytes < kProbeBytes || frame.payload_bytes > kMaxPayloadBytes) {
    return {.fault = "its length is impossible"};
  }
  if (frame.payload_bytes > window.bytes_from(payload_at)) {
    return {.fault = "it reaches beyond the end of the file"};
  }
  // The cheap test first: the search for intact records comes by at every byte.
  if (!journal_format::could_begin_payload(window.view(payload_at, kProbeBytes),
                                           frame.payload_bytes)) {
    return {.fault = "its content makes no sense"};
  }
  const std::string_view payload = window.view(payload_at, frame.payload_bytes);
  Attempt attempt{.record = journal_format::decode_payload(payload),
                  .end = payload_at + frame.payload_bytes,
                  .fault = "its content makes no sense"};
  if (attempt.record && calc_crc32(payload) != frame.checksum) {
    attempt.record.reset();
    attempt.fault = "its checksum is wrong";
  }
  return attempt;
}

// Where an intact record begins behind `offset`, if anywhere.
std::optional<std::uint64_t> find_intact_record(Window& window, std::uint64_t offset) {
  while (++offset < window.size() && window.bytes_from(offset) >= kFrameBytes + kProbeBytes) {
    if (read_record(window, offset).record) {
      return offset;
    }
  }
  return std::nullopt;
}

bool same_bits(const EvaluationRecord& a, const EvaluationRecord& b) {
  std::string bytes_a;
  std::string bytes_b;
  journal_format::encode(a, bytes_a);
  journal_format::encode(b, bytes_b);
  return bytes_a == bytes_b;
}

// Sorts by index. A record written twice counts once; two different ones cannot both be true.
void sort_training(std::vector<EvaluationRecord>& training, const std::filesystem::path& file) {
  const auto before = [](const EvaluationRecord& a, const EvaluationRecord& b) {
    return a.index < b.index;
  };
  if (!std::is_sorted(training.begin(), training.end(), before)) {
    std::stable_sort(training.begin(), training.end(), before);
  }
  const auto repeats = [&](const EvaluationRecord& first, const EvaluationRecord& second) {
    if (first.index != second.index) {
      return false;
    }
    if (!same_bits(first, second)) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: evaluation {} is recorded twice with different content; two "
                              "processes may have written this journal. It was left untouched: "
                              "start a new run with --new",
                              file.string(), first.index));
    }
    return true;
  };
  training.erase(std::unique(training.begin(), training.end(), repeats), training.end());
}

void keep(Record record, JournalContent& content) {
  if (auto* const end = std::get_if<EndRecord>(&record)) {
    content.ended = true;
    content.end = std::move(*end);
    return;
  }
  auto& evaluation = std::get<EvaluationRecord>(record);
  auto& where = evaluation.cases.role == CaseRole::training ? content.training : content.judgements;
  where.push_back(std::move(evaluation));
}

}  // namespace

JournalScan scan_journal(int fd, const std::filesystem::path& file) {
  Window window(fd, file);
  const auto begin_bytes = std::min<std::uint64_t>(window.size(), kMagic.size());
  if (window.view(0, begin_bytes) != kMagic.substr(0, begin_bytes)) {
    throw Error(ErrorKind::bad_data, fmt::format("{}: is not an armwright journal (one begins with "
                                                 "the bytes {}); it was left untouched",
                                                 file.string(), kMagic));
  }
  JournalScan scan;
  if (begin_bytes < kMagic.size()) {
    scan.content.torn_bytes = begin_bytes;
    return scan;
  }
  std::uint64_t offset = kMagic.size();
  for (std::uint64_t number = 0; offset < window.size(); ++number) {
    Attempt attempt = read_record(window, offset);
    if (!attempt.record) {
      if (const auto next = find_intact_record(window, offset)) {
        throw Error(ErrorKind::bad_data,
                    fmt::format("{}: record {} (from 0) at byte {} is damaged ({}), yet an intact "
                                "one follows at byte {}: that is not what a kill or a power cut "
                                "leaves. The journal was left untouched: restore it from a copy "
                                "or start a new run with --new",
                                file.string(), number, offset, attempt.fault, *next));
      }
      break;
    }
    if (scan.content.ended) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("{}: record {} (from 0) at byte {} follows the record that ends the "
                              "run. The journal was left untouched: restore it from a copy or "
                              "start a new run with --new",
                              file.string(), number, offset));
    }
    keep(std::move(*attempt.record), scan.content);
    offset = attempt.end;
  }
  scan.good_bytes = offset;
  scan.content.torn_bytes = window.size() - offset;
  sort_training(scan.content.training, file);
  return scan;
}

JournalContent read_journal(const std::filesystem::path& file) {
  // Not blocking, or a named pipe would be waited for forever before it could be refused.
  const FileDescriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!descriptor.is_open()) {
    throw Error(ErrorKind::io,
                fmt::format("{}: cannot open it: {}", file.string(), std::strerror(errno)));
  }
  return scan_journal(descriptor.get(), file).content;
}

}  // namespace armwright
