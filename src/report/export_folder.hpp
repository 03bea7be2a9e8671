// The folder that an export is written to: whole or not at all. It is filled under another name
// beside its own, NAME.partial-N, and renamed at the end; a kill leaves that one behind.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace armwright {

class ExportFolder {
 public:
  // Error{usage} if there is anything at `target` but an empty folder; Error{io}.
  explicit ExportFolder(const std::filesystem::path& target);
  ~ExportFolder();  // removes what was not put in place
  ExportFolder(const ExportFolder&) = delete;
  ExportFolder& operator=(const ExportFolder&) = delete;

  // Where to write until then.
  const std::filesystem::path& path() const { return path_; }
  void put_in_place();

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
};

// A new file that is written piece by piece, with the folders it needs. Error{io} names it.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path path);
  void write(std::string_view text);
  void close();  // and sync; a file that was not closed is not complete

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

void write_output_file(const std::filesystem::path& path, std::string_view text);

}  // namespace armwright
