// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/markup.h"

#include "voxtone/base/printable.h"

namespace voxtone::io {

namespace {

std::string_view reference_of(char c) {
    switch (c) {
        case '&':
            return "&amp;";
        case '<':
            return "&lt;";
        case '>':
            return "&gt;";
        case '"':
            return "&quot;";
        case '\'':
            return "&apos;";
        default:
            return {};
    }
}

}  // namespace

std::string markup_text(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    for (const char c : text) {
        const std::string_view reference = reference_of(c);
        if (reference.empty())
            result += c;
        else
            result += reference;
    }
    return result;
}

std::string html_text(std::string_view text) { return markup_text(printable(text)); }

}  // namespace voxtone::io
