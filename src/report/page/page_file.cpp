#include "report/page/page_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "base/base64.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "report/formats/export_text.hpp"

namespace armwright {
namespace {

constexpr std::size_t kPageLimit_bytes = std::size_t{1} << 30;

// Marks the file as a page, in its first 1024 bytes.
constexpr const char* kPageMark = "<meta name=\"generator\" content=\"armwright\">";
// Precedes the data.
constexpr const char* kPageDataBegin = "<script type=\"application/json\" id=\"data\">";

std::string calc_source_hash(std::string_view text) {
  return "'sha256-" + to_base64(calc_sha256(text)) + "'";
}

// Replaces every '<'. In JSON it can only stand within a string, where \u003c means the same.
std::string escape_json(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size() + text.size() / 64);
  for (const char c : text) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace

std::string make_page_html(std::string_view title, std::string_view data,
                           std::string_view live_tag) {
  const PageAssets assets = get_page_assets();
  const bool live = !live_tag.empty();
  const std::string policy = fmt::format(
      "default-src 'none'; script-src {}; style-src {}; img-src data: blob:; connect-src {}; "
      "base-uri 'none'; form-action 'none'",
      calc_source_hash(assets.script), calc_source_hash(assets.style), live ? "'self'" : "'none'");
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"{}>\n<head>\n<meta charset=\"utf-8\">\n{}\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{}</title>\n<style>",
      live ? fmt::format(" data-live=\"{}\"", escape_html(live_tag)) : "", kPageMark, policy,
      escape_html(title));
  html += assets.style;
  html +=
      "</style>\n</head>\n<body>\n<noscript>This page draws its figures with a script, which the "
      "browser has switched off.</noscript>\n<div id=\"page\"></div>\n";
  html += kPageDataBegin;
  html += escape_json(data);
  html += "</script>\n<script>";
  html += assets.script;
  html += "</script>\n</body>\n</html>\n";
  return html;
}

bool is_page_file(const std::filesystem::path& file) {
  const FileDescriptor descriptor = open_to_read(file);
  std::string beginning(1024, '\0');
  const ssize_t got = ::pread(descriptor.get(), beginning.data(), beginning.size(), 0);
  beginning.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return beginning.find(kPageMark) != std::string::npos;
}

std::string read_page_data(const std::filesystem::path& page) {
  const std::string html = read_file(page, kPageLimit_bytes);
  const std::size_t block = html.find(kPageDataBegin);
  const std::size_t begin = block + std::string_view(kPageDataBegin).size();
  const std::size_t end = block == std::string::npos ? block : html.find("</script>", begin);
  if (!is_page_file(page) || end == std::string::npos) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is not a page that armwright report wrote", page.string()));
  }
  std::string data = html.substr(begin, end - begin);
  const auto parsed = nlohmann::json::parse(data, nullptr, false);
  if (!parsed.is_object() || parsed.value("format", nlohmann::json()) != kPageFormat) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: was written by another version of armwright; make the page again "
                            "with armwright report",
                            page.string()));
  }
  return data;
}

}  // namespace armwright
