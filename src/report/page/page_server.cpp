#include "report/page/page_server.hpp"

#ifdef ARMWRIGHT_WITH_PAGE
#include <httplib.h>
#endif

#include <fmt/format.h>

#include <chrono>
#include <mutex>
#include <thread>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "report/page/page_file.hpp"

namespace armwright {

#ifdef ARMWRIGHT_WITH_PAGE

namespace {

constexpr const char* kAddress = "127.0.0.1";
// A browser keeps several connections open at a time.
constexpr std::size_t kThreads = 8;

struct TaggedData {
  std::string text;
  std::string tag;
};

}  // namespace

struct PageServer::Server {
  httplib::Server http;
  int port = 0;
  std::string title;
  std::function<std::string()> make_data;
  std::mutex mutex;  // guards the members below
  TaggedData data;
  std::chrono::steady_clock::time_point made_at;

  TaggedData get_data() {
    constexpr auto kFresh = std::chrono::seconds(1);
    const std::lock_guard lock(mutex);
    const auto now = std::chrono::steady_clock::now();
    if (data.tag.empty() || now - made_at >= kFresh) {
      data.text = make_data();
      data.tag = "\"" + calc_sha256_hex(data.text).substr(0, 16) + "\"";
      made_at = std::chrono::steady_clock::now();
    }
    return data;
  }

  bool is_ours(const httplib::Request& request) const {
    const std::string host = request.get_header_value("Host");
    return host == fmt::format("{}:{}", kAddress, port) ||
           host == fmt::format("localhost:{}", port);
  }

  void answer_page(httplib::Response& response) {
    const TaggedData now = get_data();
    response.set_content(make_page_html(title, now.text, now.tag), "text/html; charset=utf-8");
  }

  void answer_data(const httplib::Request& request, httplib::Response& response) {
    TaggedData now = get_data();
    response.set_header("ETag", now.tag);
    if (request.get_header_value("If-None-Match") == now.tag) {
      response.status = 304;
    } else {
      response.set_content(std::move(now.text), "application/json");
    }
  }
};

PageServer::PageServer(int port, std::string title, std::function<std::string()> make_data)
    : server_(std::make_unique<Server>()) {
  server_->title = std::move(title);
  server_->make_data = std::move(make_data);
  httplib::Server& http = server_->http;
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  // The library's default options would let a second server share the port.
  http.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  http.set_default_headers({{"Cache-Control", "no-store"},
                            {"X-Content-Type-Options", "nosniff"},
                            {"Referrer-Policy", "no-referrer"},
                            {"Cross-Origin-Resource-Policy", "same-origin"}});
  http.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        if (server_->is_ours(request)) {
          return httplib::Server::HandlerResponse::Unhandled;
        }
        response.status = 403;
        response.set_content("this page is served to this machine only\n", "text/plain");
        return httplib::Server::HandlerResponse::Handled;
      });
  http.set_exception_handler(
      [](const httplib::Request&, httplib::Response& response, std::exception_ptr exception) {
        response.status = 500;
        try {
          std::rethrow_exception(exception);
        } catch (const std::exception& error) {
          response.set_content(std::string(error.what()) + "\n", "text/plain; charset=utf-8");
        } catch (...) {
          response.set_content("an unknown failure\n", "text/plain");
        }
      });
  http.Get("/", [this](const httplib::Request&, httplib::Response& response) {
    server_->answer_page(response);
  });
  http.Get("/data.json", [this](const httplib::Request& request, httplib::Response& response) {
    server_->answer_data(request, response);
  });
  if (port == 0) {
    server_->port = http.bind_to_any_port(kAddress);
  } else {
    server_->port = http.bind_to_port(kAddress, port) ? port : -1;
  }
  if (server_->port <= 0) {
    throw Error(
        ErrorKind::io,
        fmt::format("{}:{} cannot be served: another program may be using this port; choose "
                    "another one with --port, or 0 for any that is free",
                    kAddress, port));
  }
}

int PageServer::port() const {
  return server_->port;
}

void PageServer::serve(StopSignal& stop) {
  std::jthread watcher([this, &stop](const std::stop_token& ended) {
    while (!ended.stop_requested()) {
      if (stop.requested()) {  // repeats it, because stop() has no effect before the server listens
        server_->http.stop();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  });
  server_->http.listen_after_bind();
}

#else

struct PageServer::Server {};

PageServer::PageServer(int, std::string, std::function<std::string()>) {
  get_page_assets();
}

int PageServer::port() const {
  return 0;
}

void PageServer::serve(StopSignal&) {}

#endif

PageServer::~PageServer() = default;

}  // namespace armwright
