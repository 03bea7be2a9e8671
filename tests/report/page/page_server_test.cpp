#include "report/page/page_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string_view>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/file_descriptor.hpp"

namespace armwright {
namespace {

using Clock = std::chrono::steady_clock;

// Connects to a port of this machine. A read that takes 20 s fails.
FileDescriptor connect_to(int port) {
  FileDescriptor client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const timeval longest{.tv_sec = 20, .tv_usec = 0};
  ::setsockopt(client.get(), SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof longest);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(client.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
            0);
  return client;
}

void put(const FileDescriptor& client, std::string_view text) {
  while (!text.empty()) {
    const ssize_t sent = ::send(client.get(), text.data(), text.size(), MSG_NOSIGNAL);
    if (sent <= 0) {
      return;  // the server has closed the connection
    }
    text.remove_prefix(static_cast<std::size_t>(sent));
  }
}

std::string read_all(const FileDescriptor& client) {
  std::string answer;
  char buffer[4096];
  for (ssize_t got = 1; got > 0;) {
    got = ::recv(client.get(), buffer, sizeof buffer, 0);
    answer.append(buffer, static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  }
  return answer;
}

class PageServerTest : public testing::Test {
 protected:
  PageServerTest()
      : server_(0, "title", [] { return std::string(R"({"kind": "run"})"); }),
        thread_([this] { server_.serve(stop_); }) {}
  ~PageServerTest() override {
    stop_.request(StopReason::terminated);
    thread_.join();
  }

  int port() const { return server_.port(); }
  std::string token() const {
    const std::string url = server_.url();
    return url.substr(url.size() - 33, 32);
  }
  std::string host() const { return fmt::format("Host: 127.0.0.1:{}\r\n", port()); }
  std::string ask(const std::string& request) const {
    const FileDescriptor client = connect_to(port());
    put(client, request);
    return read_all(client);
  }
  // Asks for a path below the token with the given headers.
  std::string get(const std::string& path, const std::string& headers) const {
    return ask(fmt::format("GET /{}{} HTTP/1.1\r\n{}\r\n", token(), path, headers));
  }

 private:
  StopSignal stop_;
  PageServer server_;
  std::thread thread_;
};

TEST(PageServer, APortIsNotShared) {
  const PageServer first(0, "first", [] { return std::string("{}"); });
  EXPECT_GT(first.port(), 0);
  try {
    PageServer(first.port(), "second", [] { return std::string("{}"); });
    FAIL() << "the port is served twice";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::io);
    EXPECT_NE(std::string(error.what()).find(std::to_string(first.port())), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("--port"), std::string::npos);
  }
}

TEST(PageServer, EndsWhenAskedTo) {
  StopSignal stop;
  stop.request(StopReason::terminated);
  PageServer server(0, "t", [] { return std::string("{}"); });
  server.serve(stop);  // returns
}

TEST(PageServer, EveryServerHasAnotherToken) {
  const PageServer one(0, "one", [] { return std::string("{}"); });
  const PageServer two(0, "two", [] { return std::string("{}"); });
  const auto get_token = [](const std::string& url) { return url.substr(url.size() - 33); };
  EXPECT_EQ(one.url(), fmt::format("http://127.0.0.1:{}/{}", one.port(), get_token(one.url())));
  EXPECT_NE(get_token(one.url()), get_token(two.url()));
}

TEST_F(PageServerTest, ServesThePageAndItsData) {
  EXPECT_TRUE(get("/", host()).starts_with("HTTP/1.1 200 OK\r\n"));
  const std::string data = get("/data.json", fmt::format("Host: localhost:{}\r\n", port()));
  EXPECT_TRUE(data.starts_with("HTTP/1.1 200 OK\r\n")) << data;
  EXPECT_TRUE(data.ends_with("\r\n\r\n{\"kind\": \"run\"}")) << data;
  EXPECT_NE(data.find("Referrer-Policy: no-referrer\r\n"), std::string::npos) << data;
  const std::size_t tag = data.find("ETag: ") + 6;
  const std::string again =
      get("/data.json",
          host() + "If-None-Match: " + data.substr(tag, data.find('\r', tag) - tag) + "\r\n");
  EXPECT_TRUE(again.starts_with("HTTP/1.1 304 Not Modified\r\n")) << again;
  EXPECT_TRUE(again.ends_with("\r\n\r\n")) << again;
}

TEST_F(PageServerTest, WithoutTheTokenNothingIsServed) {
  std::string other = token();
  other.back() = other.back() == '0' ? '1' : '0';
  for (const std::string& path :
       {std::string("/"), std::string("/data.json"), "/" + other + "/", "/" + other + "/data.json",
        "/" + token().substr(0, 31) + "/", "/" + token() + "0/", "//" + token() + "/"}) {
    const std::string answer = ask(fmt::format("GET {} HTTP/1.1\r\n{}\r\n", path, host()));
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 404 Not Found\r\n")) << path << '\n' << answer;
    EXPECT_EQ(answer.find("kind"), std::string::npos) << answer;
  }
}

TEST_F(PageServerTest, NeedsExactlyOneHostHeader) {
  const std::string evil = "host: evil.example\r\n";
  for (const std::string& headers :
       {std::string(), evil, host() + evil, evil + host(), host() + host()}) {
    const std::string answer = get("/data.json", headers);
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 403 Forbidden\r\n")) << headers << '\n' << answer;
  }
}

TEST_F(PageServerTest, RefusesOtherMethodsAndWhatIsNoRequest) {
  const auto begin = [&](const std::string& text) {
    return ask(text + host() + "\r\n").substr(0, 12);
  };
  EXPECT_EQ(begin("POST /" + token() + "/ HTTP/1.1\r\n"), "HTTP/1.1 405");
  EXPECT_EQ(begin("GET http://127.0.0.1/ HTTP/1.1\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(begin("GET / HTTP/2.0\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(begin("GET /\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(begin("GET / HTTP/1.1\r\n folded\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(begin("GET / HTTP/1.1\r\nX: a\tb\x01\r\n"), "HTTP/1.1 400");
  EXPECT_EQ(begin("\r\n\r\n"), "HTTP/1.1 400");
}

TEST_F(PageServerTest, HeadersAreLimitedTogether) {
  std::string headers = host();
  for (int i = 0; i < 400; ++i) {  // each of them is small
    headers += fmt::format("X-{}: {:40}\r\n", i, "a");
  }
  const std::string answer = get("/", headers);
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 431 ")) << answer;
  const FileDescriptor client = connect_to(port());
  put(client, "GET / HTTP/1.1\r\nX: " + std::string(std::size_t{20} << 20, 'a'));
  EXPECT_TRUE(read_all(client).size() < 1000);
}

TEST_F(PageServerTest, HalfOpenConnectionsDelayNobody) {
  std::vector<FileDescriptor> half_open;
  for (int i = 0; i < 200; ++i) {
    half_open.push_back(connect_to(port()));
    put(half_open.back(), i % 2 == 0 ? "" : "GET / HT");
  }
  const auto began = Clock::now();
  EXPECT_TRUE(get("/data.json", host()).starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_LT(Clock::now() - began, std::chrono::seconds(1));
}

TEST_F(PageServerTest, ARequestHasTenSeconds) {
  const FileDescriptor client = connect_to(port());
  const auto began = Clock::now();
  std::thread slow([&] {  // sends a byte per second, so that the connection is never silent
    for (int i = 0; i < 14 && Clock::now() - began < std::chrono::seconds(12); ++i) {
      put(client, "G");
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
  });
  EXPECT_EQ(read_all(client), "");
  const auto took = Clock::now() - began;
  slow.join();
  EXPECT_GT(took, std::chrono::seconds(9));
  EXPECT_LT(took, std::chrono::seconds(15));
}

}  // namespace
}  // namespace armwright
