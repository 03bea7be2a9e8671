// Serves a page and its newest data to browsers on this machine, for `armwright watch`. It listens
// on 127.0.0.1 only, answers only GET and HEAD of / and /data.json, and writes nothing. It refuses
// requests that name another host: a foreign web page could otherwise let its own host name point
// here and read the data.
//
//   /           the page with the current data
//   /data.json  the data alone; 304 if they have the tag in If-None-Match
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/stop_signal.hpp"

namespace armwright {

class PageServer {
 public:
  // `make_data` returns JSON. The server calls it at most once per second, for any number of
  // browsers and never at the same time on two threads. If it throws, the answer is 500 with the
  // message. `port` 0 stands for any free port. Throws Error{io} if the port cannot be bound;
  // Error{usage} if this build has no page.
  PageServer(int port, std::string title, std::function<std::string()> make_data);
  ~PageServer();

  int port() const;
  // Answers requests until `stop` is requested.
  void serve(StopSignal& stop);

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace armwright
