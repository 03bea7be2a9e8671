// Serves a page and its newest data to one user's browsers on this machine, for `armwright watch`.
// It listens on 127.0.0.1 only and writes nothing.
//
//   /TOKEN/           the page with the current data
//   /TOKEN/data.json  the data alone; 304 if they have the tag in If-None-Match
//
// TOKEN has 128 random bits. Other users of this machine do not know it and get 404. A foreign web
// page could let its own host name point here; a request therefore needs exactly one Host header,
// which names this address. Methods other than GET and HEAD get 405.
//
// Limits: 64 connections; 16 KiB and 10 s for a request. At the 65th connection, the oldest one
// whose request is incomplete is closed, so half-open connections delay nobody. Each connection
// carries one request.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/stop_signal.hpp"

namespace armwright {

class PageServer {
 public:
  // `make_data` returns JSON. The thread of serve() calls it at most once per second, for any
  // number of browsers. If it throws, the answer is 500 with the message. `port` 0 stands for any
  // free port. Throws Error{io} if the port cannot be bound; Error{usage} if this build has no page.
  PageServer(int port, std::string title, std::function<std::string()> make_data);
  ~PageServer();

  // Returns the page's address, with the token.
  std::string url() const;
  int port() const;
  // Answers requests until `stop` is requested.
  void serve(StopSignal& stop);

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace armwright
