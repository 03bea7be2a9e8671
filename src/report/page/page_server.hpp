// Serves a page and its newest data to browsers on this machine: for `armwright watch`. It binds
// 127.0.0.1 only, answers GET and HEAD of / and /data.json only, writes nothing, and refuses
// requests that name another host (a page elsewhere could otherwise point its own name here and
// read along).
//
//   /           the page, with the data of that moment in it
//   /data.json  the data alone; 304 where they have the tag in If-None-Match
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/stop_signal.hpp"

namespace armwright {

class PageServer {
 public:
  // `make_data`: JSON, made anew at most once a second, however many ask. What it throws becomes
  // the text of an answer 500. `port`: 0 for any that is free. Error{io} if it cannot be bound.
  PageServer(int port, std::string title, std::function<std::string()> make_data);
  ~PageServer();

  int port() const;
  // Answers until `stop` is requested.
  void serve(StopSignal& stop);

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace armwright
