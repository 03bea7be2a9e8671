// Writes and reads the page as one HTML file, which contains its script, style and data.
//
// Nothing in the data can become markup or code. The data are JSON in a block that browsers do not
// run, with every '<' written as \u003c. A content security policy names the one script and the one
// style by their SHA-256 and forbids everything else, including the network.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace armwright {

// The built files of web/, which the program contains.
struct PageAssets {
  std::string_view script;   // the page's, one classic script
  std::string_view style;    // CSS
  std::string_view figures;  // the figures without a browser, ES5 (report/page/plotter.hpp)
};

// Throws Error{usage} if this build has no page; the message says how to get one.
PageAssets get_page_assets();

// Returns the file's text. `data` is JSON (web/src/data.ts). `live_tag` is empty except for a page
// that the program itself serves: that page asks for data that are newer than those with this tag
// (report/page/page_server.hpp).
std::string make_page_html(std::string_view title, std::string_view data,
                           std::string_view live_tag = {});

// "format" of the data. It changes when the page needs keys that earlier data do not have.
inline constexpr int kPageFormat = 2;

// Returns whether make_page_html() made a file.
bool is_page_file(const std::filesystem::path& file);
// Returns the data in such a file. Throws Error{bad_data} if the file is no such page or its data have
// another format; Error{io}.
std::string read_page_data(const std::filesystem::path& page);

}  // namespace armwright
