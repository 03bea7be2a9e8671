#include "report/page/page_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <list>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/file_descriptor.hpp"
#include "base/hash.hpp"
#include "report/page/http_request.hpp"
#include "report/page/page_file.hpp"

namespace armwright {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kAddress = "127.0.0.1";
constexpr std::size_t kMostConnections = 64;
constexpr std::chrono::seconds kRequestTime{10};
// A browser behind a slow line may take longer for the page, as long as it takes some of it.
constexpr std::chrono::seconds kSilenceTime{10};
// The time to wait for the end of what the client still sends behind its request. A connection
// that is closed before would lose the answer.
constexpr std::chrono::seconds kDrainTime{1};
constexpr std::chrono::milliseconds kStopLook{50};

using SharedText = std::shared_ptr<const std::string>;  // shared by all connections that send it

std::string make_token() {
  std::array<unsigned char, 16> bits{};
  if (::getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size())) {
    fail_io("getrandom", "draw a random token", errno);
  }
  std::string token;
  for (const unsigned char byte : bits) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

// Compares in a time that does not depend on where the texts differ.
bool equals_secret(std::string_view text, std::string_view secret) {
  unsigned difference = text.size() == secret.size() ? 0 : 1;
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const char c = i < text.size() ? text[i] : '\0';
    difference |= static_cast<unsigned char>(c) ^ static_cast<unsigned char>(secret[i]);
  }
  return difference == 0;
}

struct Answer {
  std::string_view status;  // as in "404 Not Found"
  std::string_view type = "text/plain; charset=utf-8";
  SharedText body;
  std::string tag = {};
};

Answer make_refusal(std::string_view status, std::string_view why) {
  return {.status = status, .body = std::make_shared<std::string>(std::string(why) + "\n")};
}

std::string make_head(const Answer& answer) {
  std::string head = fmt::format(
      "HTTP/1.1 {}\r\nConnection: close\r\nCache-Control: no-store\r\n"
      "X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\n",
      answer.status);
  if (!answer.tag.empty()) {
    head += fmt::format("ETag: {}\r\n", answer.tag);
  }
  if (answer.status.starts_with("405")) {
    head += "Allow: GET, HEAD\r\n";
  }
  if (answer.body) {
    head +=
        fmt::format("Content-Type: {}\r\nContent-Length: {}\r\n", answer.type, answer.body->size());
  }
  return head + "\r\n";
}

// One connection: it receives a request, sends the answer, and waits for the client to close.
struct Connection {
  enum class State { receiving, sending, draining };
  explicit Connection(int fd) : socket(fd), deadline(Clock::now() + kRequestTime) {}

  FileDescriptor socket;
  Clock::time_point deadline;
  State state = State::receiving;
  std::string received = {};
  std::string head = {};
  SharedText body = {};
  std::size_t sent = 0;  // bytes of head and body
};

FileDescriptor listen_on(int port) {
  FileDescriptor listener(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int yes = 1;
  ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener.get(), SOMAXCONN) != 0) {
    throw Error(
        ErrorKind::io,
        fmt::format("{}:{} cannot be served: another program may be using this port; choose "
                    "another one with --port, or 0 for any that is free",
                    kAddress, port));
  }
  return listener;
}

int read_port(int listener) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

bool must_wait() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

}  // namespace

class PageServer::Server {
 public:
  Server(int port, std::string title, std::function<std::string()> make_data)
      : title_(std::move(title)),
        make_data_(std::move(make_data)),
        listener_(listen_on(port)),
        port_(read_port(listener_.get())),
        token_(make_token()) {}

  int port() const { return port_; }
  std::string url() const { return fmt::format("http://{}:{}/{}/", kAddress, port_, token_); }

  // Waits at most `kStopLook` and does what can be done without waiting.
  void step() {
    const bool has_room = make_room();
    std::vector<pollfd> polled = {
        {.fd = has_room ? listener_.get() : -1, .events = POLLIN, .revents = 0}};
    for (const Connection& one : connections_) {
      const bool sends = one.state == Connection::State::sending;
      polled.push_back({.fd = one.socket.get(),
                        .events = static_cast<short>(sends ? POLLOUT : POLLIN),
                        .revents = 0});
    }
    if (::poll(polled.data(), polled.size(), static_cast<int>(kStopLook.count())) < 0) {
      return;  // a signal; the caller looks for it
    }
    std::size_t at = 1;
    for (auto one = connections_.begin(); one != connections_.end(); ++at) {
      const bool goes_on =
          (polled[at].revents == 0 || advance(*one)) && Clock::now() < one->deadline;
      one = goes_on ? std::next(one) : connections_.erase(one);
    }
    if (polled[0].revents != 0) {
      accept_one();
    }
  }

 private:
  // Returns whether another connection can be accepted. Closes one for it if necessary: the oldest
  // that has not sent its request or waits for the client's end.
  bool make_room() {
    if (connections_.size() < kMostConnections) {
      return true;
    }
    pollfd next{.fd = listener_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&next, 1, 0) != 1) {
      return true;  // nobody waits yet
    }
    const auto idle = std::ranges::find_if(connections_, [](const Connection& one) {
      return one.state != Connection::State::sending;
    });
    if (idle == connections_.end()) {
      return false;
    }
    connections_.erase(idle);
    return true;
  }

  void accept_one() {
    const int fd = ::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd >= 0) {
      connections_.emplace_back(fd);
    }
  }

  // Does the next part of a connection's work. Returns whether the connection stays open.
  bool advance(Connection& one) {
    switch (one.state) {
      case Connection::State::receiving:
        return receive(one);
      case Connection::State::sending:
        return send(one);
      case Connection::State::draining:
        break;
    }
    return drain(one);
  }

  bool receive(Connection& one) {
    std::array<char, 4096> buffer;
    const ssize_t got = ::recv(one.socket.get(), buffer.data(), buffer.size(), 0);
    if (got <= 0) {
      return got < 0 && must_wait();
    }
    one.received.append(buffer.data(), static_cast<std::size_t>(got));
    const auto head_bytes = find_head_end(one.received);
    if (!head_bytes && one.received.size() <= kRequestHeadLimit_bytes) {
      return true;
    }
    if (!head_bytes || *head_bytes > kRequestHeadLimit_bytes) {
      begin_answer(
          one,
          make_refusal("431 Request Header Fields Too Large",
                       fmt::format("a request may have {} bytes", kRequestHeadLimit_bytes)),
          true);
    } else if (const auto request =
                   parse_request_head(std::string_view(one.received).substr(0, *head_bytes))) {
      begin_answer(one, answer(*request), request->method != "HEAD");
    } else {
      begin_answer(one, make_refusal("400 Bad Request", "this is not an HTTP/1.1 request"), true);
    }
    one.received.clear();
    return send(one);
  }

  static void begin_answer(Connection& one, const Answer& answer, bool with_body) {
    one.head = make_head(answer);
    one.body = with_body ? answer.body : nullptr;
    one.state = Connection::State::sending;
    one.deadline = Clock::now() + kSilenceTime;
  }

  static bool send(Connection& one) {
    const std::string_view body = one.body ? std::string_view(*one.body) : std::string_view();
    while (one.sent < one.head.size() + body.size()) {
      const std::string_view rest = one.sent < one.head.size()
                                        ? std::string_view(one.head).substr(one.sent)
                                        : body.substr(one.sent - one.head.size());
      const ssize_t put = ::send(one.socket.get(), rest.data(), rest.size(), MSG_NOSIGNAL);
      if (put < 0) {
        return must_wait();
      }
      one.sent += static_cast<std::size_t>(put);
      one.deadline = Clock::now() + kSilenceTime;
    }
    one.body = nullptr;
    ::shutdown(one.socket.get(), SHUT_WR);
    one.state = Connection::State::draining;
    one.deadline = Clock::now() + kDrainTime;
    return true;
  }

  static bool drain(Connection& one) {
    std::array<char, 4096> buffer;
    const ssize_t got = ::recv(one.socket.get(), buffer.data(), buffer.size(), 0);
    return got > 0 || (got < 0 && must_wait());
  }

  Answer answer(const HttpRequest& request) {
    if (request.hosts.size() != 1 ||
        (request.hosts.front() != fmt::format("{}:{}", kAddress, port_) &&
         request.hosts.front() != fmt::format("localhost:{}", port_))) {
      return make_refusal("403 Forbidden", "this page is served to this machine only");
    }
    const std::string_view path = std::string_view(request.target).substr(1);
    const std::string_view token = path.substr(0, path.find('/'));
    if (!equals_secret(token, token_)) {
      return make_refusal("404 Not Found",
                          "nothing is here; open the whole address that 'armwright watch' printed");
    }
    if (request.method != "GET" && request.method != "HEAD") {
      return make_refusal("405 Method Not Allowed", "this server answers GET and HEAD");
    }
    const std::string_view name = path.substr(token.size());
    if (name != "/" && name != "/data.json") {
      return make_refusal("404 Not Found", "nothing is here");
    }
    try {
      renew_data();
      return name == "/" ? answer_page() : answer_data(request);
    } catch (const std::exception& error) {
      return make_refusal("500 Internal Server Error", error.what());
    }
  }

  void renew_data() {
    constexpr auto kFresh = std::chrono::seconds(1);
    if (data_ && Clock::now() - made_at_ < kFresh) {
      return;
    }
    auto data = std::make_shared<const std::string>(make_data_());
    std::string tag = "\"" + calc_sha256_hex(*data).substr(0, 16) + "\"";
    if (tag != tag_) {
      data_ = std::move(data);
      tag_ = std::move(tag);
      page_ = nullptr;
    }
    made_at_ = Clock::now();
  }

  Answer answer_page() {
    if (!page_) {
      page_ = std::make_shared<const std::string>(make_page_html(title_, *data_, tag_));
    }
    return {.status = "200 OK", .type = "text/html; charset=utf-8", .body = page_};
  }

  Answer answer_data(const HttpRequest& request) const {
    if (request.if_none_match == tag_) {
      return {.status = "304 Not Modified", .body = nullptr, .tag = tag_};
    }
    return {.status = "200 OK", .type = "application/json", .body = data_, .tag = tag_};
  }

  std::string title_;
  std::function<std::string()> make_data_;
  FileDescriptor listener_;
  int port_;
  std::string token_;
  std::list<Connection> connections_;  // in the order of their arrival
  SharedText data_;
  std::string tag_;
  SharedText page_;  // the page with data_; null until a browser asks for it
  Clock::time_point made_at_;
};

PageServer::PageServer(int port, std::string title, std::function<std::string()> make_data) {
  get_page_assets();  // throws if this build has no page
  server_ = std::make_unique<Server>(port, std::move(title), std::move(make_data));
}

PageServer::~PageServer() = default;

std::string PageServer::url() const {
  return server_->url();
}

int PageServer::port() const {
  return server_->port();
}

void PageServer::serve(StopSignal& stop) {
  while (!stop.requested()) {
    server_->step();
  }
}

}  // namespace armwright
