// Publishes a finished cell: one rename moves it from its attempt into the study.

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>

#include <cerrno>
#include <string>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "study/compare/cell.hpp"
#include "study/journal/journal_file.hpp"
#include "study/matrix/attempt.hpp"
#include "study/run/run_lock.hpp"

namespace armwright {
namespace {

void move_aside(const std::filesystem::path& target, const std::filesystem::path& aside) {
  if (const std::string writer = find_writer(target); !writer.empty()) {
    throw Error(ErrorKind::busy,
                fmt::format("{} is being written by {}, which will finish it; the cell of this "
                            "attempt is kept but not needed",
                            sanitize(target.string()), writer));
  }
  std::filesystem::path free = aside;
  for (int number = 2; path_exists(free); ++number) {
    free = fmt::format("{}-{}", aside.string(), number);
  }
  const bool had_record = path_exists(target / "cell.json");
  if (::rename(target.c_str(), free.c_str()) != 0) {
    if (errno != ENOENT) {  // ENOENT: another process has moved it at the same moment
      fail_io(target, "move it aside to " + free.string(), errno);
    }
    return;
  }
  // Another process may have put a finished cell there just before the rename. Move it back, unless
  // a further one is in its place already.
  if (!had_record && path_exists(free / "cell.json") &&
      ::rename(free.c_str(), target.c_str()) != 0 && errno != ENOTEMPTY && errno != EEXIST) {
    fail_io(free, "move it back to " + target.string(), errno);
  }
}

}  // namespace

bool publish_cell(const StudyPlan& plan, const Cell& cell, const std::filesystem::path& study,
                  const std::filesystem::path& run, const std::filesystem::path& aside) {
  const auto target = study / make_cell_path(plan, cell);
  const Folder parent = Folder::make(target.parent_path(), study);
  // In each round this or another process moves the unfinished cell aside. There are at most as
  // many rounds as processes that run this cell.
  constexpr int kMostRounds = 1000;
  for (int round = 0; round < kMostRounds; ++round) {
    if (load_cell(plan, cell, study)) {
      return false;
    }
    if (::renameat(AT_FDCWD, run.c_str(), parent.get(), target.filename().c_str()) == 0) {
      parent.sync();
      return true;
    }
    const int error = errno;
    // A network file system may have renamed the folder and then lost the reply.
    if (error == ENOENT && load_cell(plan, cell, study)) {
      return true;
    }
    if (error != ENOTEMPTY && error != EEXIST) {
      fail_io(target, "put the finished cell in place", error);
    }
    if (!load_cell(plan, cell, study)) {
      move_aside(target, aside);
    }
  }
  throw Error(ErrorKind::busy,
              fmt::format("{}: other processes keep putting unfinished cells there",
                          sanitize(target.string())));
}

}  // namespace armwright
