#include "report/page/page_file.hpp"

#include <fmt/format.h>

#include "base/base64.hpp"
#include "base/hash.hpp"
#include "report/formats/html_text.hpp"
#include "report/page/page_assets.hpp"

namespace armwright {
namespace {

std::string calc_source_hash(std::string_view text) {
  return "'sha256-" + to_base64(calc_sha256(text)) + "'";
}

// In JSON a '<' can only stand within a text, where \u003c means the same.
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

}  // namespace armwright
