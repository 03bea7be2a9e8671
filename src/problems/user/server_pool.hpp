// The servers of one problem. Each thread that simulates takes one and gives it back. A pool is
// thread-safe.
#pragma once

#include <sys/types.h>

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "problems/user/case_server.hpp"

namespace armwright {

// A forked child begins with an empty pool: the servers in the pool that it inherits belong to its
// parent, so the child neither uses nor ends them.
class ServerPool {
 public:
  explicit ServerPool(std::function<std::unique_ptr<CaseServer>()> start);
  ~ServerPool();
  ServerPool(const ServerPool&) = delete;
  ServerPool& operator=(const ServerPool&) = delete;

  // Returns an idle server, or starts one; with `is_new` always starts one. Throws what starting
  // throws.
  std::unique_ptr<CaseServer> take(bool is_new = false);
  void give_back(std::unique_ptr<CaseServer> server);

 private:
  class Launcher;

  void disown_inherited();

  std::function<std::unique_ptr<CaseServer>()> start_;
  std::mutex mutex_;
  pid_t owner_ = -1;  // the process that the members below belong to
  std::vector<std::unique_ptr<CaseServer>> idle_;
  std::unique_ptr<Launcher> launcher_;
};

}  // namespace armwright
