// The folder that an export is written to: whole or not at all (base/partial_folder.hpp).
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/partial_folder.hpp"

namespace armwright {

class ExportFolder {
 public:
  // Error{usage} if there is anything at `target` but an empty folder; Error{io}.
  explicit ExportFolder(const std::filesystem::path& target);

  // Where to write until then.
  const std::filesystem::path& path() const { return folder_.path(); }
  void put_in_place();

 private:
  PartialFolder folder_;
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
