// SPDX-License-Identifier: GPL-3.0-or-later
//
// Text that may hold anything, for element content and quoted attributes of HTML, SVG and XML.
#pragma once

#include <string>
#include <string_view>

namespace voxtone::io {

/// & < > " ' as references; all else stays.
[[nodiscard]] std::string markup_text(std::string_view text);

/// For pages that people look at: valid UTF-8 without control characters (base/printable.h), then as above.
[[nodiscard]] std::string html_text(std::string_view text);

}  // namespace voxtone::io
