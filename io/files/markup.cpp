// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/markup.h"

#include <span>

#include <fmt/core.h>

#include "base/contracts.h"
#include "base/embedded_file.h"
#include "base/printable.h"

namespace voxtone::embedded {
std::span<const EmbeddedFile> page_assets();
}

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

std::string link_text(std::string_view path) {
    std::string link;
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~/";
    for (const char c : path)
        link += plain.find(c) != std::string_view::npos ? std::string(1, c)
                                                        : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    return link;
}

std::string_view page_asset(std::string_view name) {
    for (const EmbeddedFile& file : embedded::page_assets())
        if (file.name == name) return file.text;
    VOXTONE_EXPECT(!"an asset of a page");
    return {};
}

std::string in_script(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    for (const char c : text) {
        if (c == '<')
            result += "\\u003c";
        else
            result += c;
    }
    return result;
}

std::string page_start(std::string_view title, std::string_view style, std::string_view below, bool with_scripts) {
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
        "'unsafe-inline'{3}\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>{0} - voxtone</title>\n<style>\n{1}</style>\n</head>\n<body>\n<header>\n<h1>{0}</h1>\n"
        "{2}</header>\n<main>\n",
        html_text(title), style, below, with_scripts ? "; script-src 'unsafe-inline'" : "");
}

}  // namespace voxtone::io
