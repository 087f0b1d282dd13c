// SPDX-License-Identifier: GPL-3.0-or-later
//
// Text that may hold anything, for element content and quoted attributes of HTML, SVG and XML; and how every page that
// the program writes begins, with the style and the scripts of data/report/, which were put into it.
#pragma once

#include <string>
#include <string_view>

namespace voxtone::io {

/// & < > " ' as references; all else stays.
[[nodiscard]] std::string markup_text(std::string_view text);

/// For pages that people look at: valid UTF-8 without control characters (base/printable.h), then as above.
[[nodiscard]] std::string html_text(std::string_view text);

/// A path of the file system as it stands in a link: slashes stay.
[[nodiscard]] std::string link_text(std::string_view path);

/// By its name without folder and extension.
[[nodiscard]] std::string_view page_asset(std::string_view name);

/// JSON as it may stand inside a script element: no '<' remains that could end it.
[[nodiscard]] std::string in_script(std::string_view json);

/// From the doctype to the opened <main>, under a heading. `style`: CSS; `below`: HTML under the heading. The page asks
/// for nothing from outside, and runs scripts of its own only where it says so.
[[nodiscard]] std::string page_start(std::string_view title, std::string_view style, std::string_view below,
                                     bool with_scripts = false);

}  // namespace voxtone::io
