#ifdef ARMWRIGHT_WITH_MUJOCO

#include "sim/robot/mujoco_library.hpp"

#include <fmt/format.h>

#include <atomic>
#include <cstring>
#include <mutex>
#include <new>
#include <stdexcept>

namespace armwright {
namespace {

void delete_files(mjVFS* files) {
  mj_deleteVFS(files);
  delete files;
}

using Handler = void (*)(const char*);

void throw_message(const char* message) {
  throw std::runtime_error(fmt::format("MuJoCo stopped: {}", message));
}
void ignore_message(const char* /*message*/) {}

// Sets a handler of the process if it has none: handlers of the engine `mujoco` stay.
void set_missing(Handler& place, Handler handler) {
  Handler none = nullptr;
  std::atomic_ref(place).compare_exchange_strong(none, handler);
}

}  // namespace

MujocoModelHandle compile_mjcf(const std::string& main,
                               const std::map<std::string, std::string>& files,
                               std::string& message) {
  const std::unique_ptr<mjVFS, MujocoDeleter<delete_files>> in_memory(
      new mjVFS);  // 2 MB: not zeroed, not on the stack
  mj_defaultVFS(in_memory.get());
  for (const auto& [name, content] : files) {
    if (mj_makeEmptyFileVFS(in_memory.get(), name.c_str(), static_cast<int>(content.size())) != 0) {
      throw std::bad_alloc();
    }
    std::memcpy(in_memory->filedata[mj_findFileVFS(in_memory.get(), name.c_str())], content.data(),
                content.size());
  }
  // Without handlers MuJoCo writes a log file into the current folder, and an error ends the process.
  set_missing(mju_user_error, throw_message);
  set_missing(mju_user_warning, ignore_message);
  char reason[1000] = "";
  MujocoModelHandle model;
  {
    static std::mutex mutex;  // all threads share the text that the library read last
    const std::lock_guard lock(mutex);
    try {
      model.reset(mj_loadXML(main.c_str(), in_memory.get(), reason, sizeof reason));
    } catch (const std::runtime_error& error) {
      message = error.what();
      return nullptr;
    }
    mj_freeLastXML();
  }
  if (model == nullptr) {
    message = reason;
  }
  return model;
}

}  // namespace armwright

#endif
