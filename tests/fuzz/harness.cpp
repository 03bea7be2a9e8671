#include "fuzz/harness.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <map>

#include "base/file_descriptor.hpp"
#include "base/text.hpp"

namespace armwright::fuzz {
namespace {

// Removed at the end of the process, unless that is a crash.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& name) {
    const std::filesystem::path memory = "/dev/shm";
    std::error_code ignored;
    const auto parent = std::filesystem::is_directory(memory, ignored)
                            ? memory
                            : std::filesystem::temp_directory_path();
    path_ = parent / fmt::format("armwright-fuzz-{}-{}", getpid(), name);
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

void require(bool holds, const std::string& what) {
  if (!holds) {
    throw BrokenPromise(what);
  }
}

void check_message(std::string_view message) {
  constexpr std::size_t kLongest = std::size_t{64} << 10;
  require(!message.empty(), "a refusal without a word");
  require(message.size() <= kLongest, fmt::format("a refusal of {} bytes", message.size()));
  for (const std::string& line : split(message, '\n')) {
    require(sanitize(line) == line,
            fmt::format("a refusal that is not printable: {}", sanitize(line)));
  }
}

const std::filesystem::path& get_scratch_folder(const std::string& name) {
  static std::map<std::string, ScratchFolder> folders;
  return folders.try_emplace(name, name).first->second.path();
}

void write_scratch(const std::filesystem::path& file, std::string_view content) {
  const FileDescriptor descriptor(
      ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  require(descriptor.is_open() && ::write(descriptor.get(), content.data(), content.size()) ==
                                      static_cast<ssize_t>(content.size()),
          fmt::format("{} cannot be written", file.string()));
}

}  // namespace armwright::fuzz
