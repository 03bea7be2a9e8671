#include "study/journal/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/file_descriptor.hpp"
#include "study/journal/journal_file.hpp"
#include "study/journal/journal_format.hpp"
#include "study/journal/journal_reader.hpp"

namespace armwright {
namespace {

using Clock = std::chrono::steady_clock;

// Half of the documented 10 ms, so that a thread that wakes up late is still in time.
constexpr auto kWriteInterval = std::chrono::milliseconds(5);
constexpr auto kSyncInterval = std::chrono::seconds(1);
// Fits a core's L2 cache; larger writes gain nothing.
constexpr std::size_t kBufferBytes = std::size_t{256} << 10;

// Returns a second descriptor, to read records while new ones are appended.
FileDescriptor duplicate(const FileDescriptor& fd, const std::filesystem::path& file) {
  FileDescriptor copy(::fcntl(fd.get(), F_DUPFD_CLOEXEC, 0));
  if (!copy.is_open()) {
    fail_io(file, "open it a second time", errno);
  }
  return copy;
}

}  // namespace

// A writer has two threads, which sleep unless there is something to do. One writes the buffer that
// append() fills, the other syncs. A sync can take long on a slow disk, and records must reach the
// operating system meanwhile.
class Journal::Writer {
 public:
  Writer(const Folder& folder, const std::string& name, JournalContent& content)
      : folder_(folder),
        file_(folder.path() / name),
        fd_(folder.open(name, O_RDWR | O_CREAT | O_APPEND)) {
    JournalContent found = scan_journal(duplicate(fd_, file_), file_);
    if (found.torn_bytes != 0) {
      cut_torn_end(fd_.get(), found.intact_bytes, folder_, name);
      unsynced_ = true;
    }
    intact_bytes_ = found.intact_bytes;
    ended_ = found.ended;
    if (intact_bytes_ == 0) {
      begin_file();
    }
    start_threads();
    content = std::move(found);
  }

  ~Writer() { stop_threads(); }

  template <class Record>
  void append(const Record& record) {
    constexpr bool continues = std::is_same_v<Record, ContinueRecord>;
    const std::string bytes = encode(record);  // outside the lock, in parallel
    const std::lock_guard lock(mutex_);
    ended_ = ended_ && !continues;
    add(bytes);
    ended_ = std::is_same_v<Record, EndRecord>;
    if (continues) {
      write_buffer();
      unsynced_ = false;
      remember_error("sync it to the disk", sync_data(fd_.get()));
      throw_if_failed();
    }
  }

  void flush() {
    const std::lock_guard lock(mutex_);
    write_buffer();
    throw_if_failed();
  }

  void close() {
    stop_threads();
    const std::lock_guard lock(mutex_);
    if (!fd_.is_open()) {
      return;
    }
    write_buffer();
    if (error_.empty() && unsynced_) {
      remember_error("sync it to the disk", sync_data(fd_.get()));
    }
    if (fd_.close() != 0) {
      remember_error("close it", errno);
    }
    throw_if_failed();
  }

 private:
  template <class Record>
  std::string encode(const Record& record) const {
    try {
      std::string bytes;
      journal_format::encode(record, bytes);
      return bytes;
    } catch (const Error& error) {
      throw Error(error.kind(), fmt::format("{}: {}", file_.string(), error.what()));
    }
  }

  void begin_file() {
    const WriteResult result = write_fully(fd_.get(), journal_format::kMagic);
    if (result.error != 0) {
      fail_io(file_, "write it", result.error);
    }
    intact_bytes_ = journal_format::kMagic.size();
    unsynced_ = true;
    folder_.sync();
  }

  // If the system grants no more threads, add() writes every record at once instead. Returns when
  // the threads wait for work: a child that is forked while a thread starts may inherit a lock that
  // the thread holds (study/executor/thread_pool.cpp).
  void start_threads() {
    try {
      write_thread_ = std::thread([this] { write_loop(); });
      sync_thread_ = std::thread([this] { sync_loop(); });
    } catch (const std::system_error&) {
      // has_threads_ stays false
    }
    const int threads = (write_thread_.joinable() ? 1 : 0) + (sync_thread_.joinable() ? 1 : 0);
    std::unique_lock lock(mutex_);
    thread_started_.wait(lock, [&] { return started_threads_ == threads; });
    has_threads_ = threads == 2;
  }

  void stop_threads() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    write_wanted_.notify_all();
    sync_wanted_.notify_all();
    for (std::thread* const thread : {&write_thread_, &sync_thread_}) {
      if (thread->joinable()) {
        thread->join();
      }
    }
  }

  // The caller of each function below must hold mutex_.

  void add(std::string_view record) {
    throw_if_failed();
    if (!fd_.is_open()) {
      throw std::logic_error("append to a closed journal");
    }
    if (ended_) {
      throw std::logic_error("append to a journal whose run has ended");
    }
    buffer_ += record;
    const auto now = Clock::now();
    if (!has_threads_ || now - last_write_ >= kWriteInterval || buffer_.size() > kBufferBytes) {
      write_buffer(now);
      if (!has_threads_ && unsynced_ && now - last_sync_ >= kSyncInterval) {
        last_sync_ = now;
        unsynced_ = false;
        remember_error("sync it to the disk", sync_data(fd_.get()));
      }
      throw_if_failed();
    } else if (writer_idle_) {
      writer_idle_ = false;
      write_wanted_.notify_one();
    }
  }

  void write_buffer(Clock::time_point now = Clock::now()) {
    if (!error_.empty()) {
      buffer_.clear();  // never written; the writing thread would try again without end
    }
    if (buffer_.empty()) {
      return;
    }
    last_write_ = now;
    const WriteResult result = write_fully(fd_.get(), buffer_);
    if (result.error != 0) {
      intact_bytes_ += journal_format::count_whole_record_bytes(
          std::string_view(buffer_).substr(0, result.written));
      // If this fails as well, the next opening finds a torn end and cuts it off.
      [[maybe_unused]] const int cut = ::ftruncate(fd_.get(), static_cast<off_t>(intact_bytes_));
      remember_error("write it", result.error);
    } else {
      intact_bytes_ += buffer_.size();
      if (is_deleted(fd_.get())) {
        error_ = fmt::format("{}: was deleted while the run was writing it", file_.string());
      }
    }
    buffer_.clear();
    if (!unsynced_) {
      unsynced_ = true;
      sync_wanted_.notify_one();
    }
  }

  // Keeps the first error for good, because no record may follow one that was not written.
  void remember_error(std::string_view doing, int error) {
    if (error != 0 && error_.empty()) {
      error_ = fmt::format(
          "{}: cannot {}: {}; once this is put right, the same command resumes the "
          "run from the records that are intact",
          file_.string(), doing, std::strerror(error));
    }
  }

  void throw_if_failed() const {
    if (!error_.empty()) {
      throw Error(ErrorKind::io, error_);
    }
  }

  // The loops of the two threads.

  void write_loop() {
    std::unique_lock lock(mutex_);
    ++started_threads_;
    thread_started_.notify_one();
    while (!stopping_) {
      if (buffer_.empty()) {
        writer_idle_ = true;
        write_wanted_.wait(lock, [this] { return stopping_ || !buffer_.empty(); });
        writer_idle_ = false;
        continue;
      }
      // add() writes at once if the last write is longer ago, so no record waits longer than this.
      const auto due = last_write_ + kWriteInterval;
      if (Clock::now() >= due) {
        write_buffer();
      } else {
        write_wanted_.wait_until(lock, due, [this] { return stopping_; });
      }
    }
  }

  void sync_loop() {
    std::unique_lock lock(mutex_);
    ++started_threads_;
    thread_started_.notify_one();
    while (true) {
      sync_wanted_.wait(lock, [this] { return stopping_ || unsynced_; });
      sync_wanted_.wait_until(lock, last_sync_ + kSyncInterval, [this] { return stopping_; });
      if (stopping_) {
        return;  // close() syncs
      }
      unsynced_ = false;
      last_sync_ = Clock::now();
      lock.unlock();
      const int error = sync_data(fd_.get());
      lock.lock();
      remember_error("sync it to the disk", error);
    }
  }

  const Folder folder_;
  const std::filesystem::path file_;
  FileDescriptor fd_;
  std::mutex mutex_;  // guards all that follows
  std::condition_variable write_wanted_;
  std::condition_variable sync_wanted_;
  std::condition_variable thread_started_;
  std::string buffer_;              // whole records
  std::uint64_t intact_bytes_ = 0;  // of the file: the magic and whole records
  std::string error_;               // the first one, empty if there is none
  bool ended_ = false;
  bool unsynced_ = false;
  bool writer_idle_ = false;
  int started_threads_ = 0;
  bool has_threads_ = false;
  bool stopping_ = false;
  Clock::time_point last_write_ = Clock::now();
  Clock::time_point last_sync_ = Clock::now();
  std::thread write_thread_;
  std::thread sync_thread_;
};

Journal::Journal(const Folder& folder, const std::string& name, JournalContent& content)
    : writer_(std::make_unique<Writer>(folder, name, content)) {}

Journal::Journal(const std::filesystem::path& file, JournalContent& content)
    : Journal(Folder(file.parent_path()), file.filename().string(), content) {}

Journal::~Journal() {
  try {
    close();
  } catch (const std::exception&) {
    // As documented, this error is lost; close() would throw it.
  }
}

void Journal::append(const EvaluationRecord& record) {
  writer_->append(record);
}
void Journal::append(const LateRecommendations& record) {
  writer_->append(record);
}
void Journal::append(const EndRecord& record) {
  writer_->append(record);
}
void Journal::append(const ContinueRecord& record) {
  writer_->append(record);
}
void Journal::flush() {
  writer_->flush();
}
void Journal::close() {
  writer_->close();
}

}  // namespace armwright
