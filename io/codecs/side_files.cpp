// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/side_files.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

namespace voxtone::io {

namespace fs = std::filesystem;

namespace {

std::string lower(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

bool is_file(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error);
}

std::vector<std::string> parts_of(std::string_view name) {
    std::vector<std::string> parts;
    std::string part;
    for (const char c : name) {
        if (c == '/' || c == '\\') {
            if (!part.empty() && part != ".") parts.push_back(part);
            part.clear();
        } else {
            part += c;
        }
    }
    if (!part.empty() && part != ".") parts.push_back(part);
    return parts;
}

bool leaves_folder(std::string_view name, const std::vector<std::string>& parts) {
    if (name.front() == '/' || name.front() == '\\') return true;
    if (name.size() > 1 && name[1] == ':') return true;  // a drive letter
    if (name.find("://") != std::string_view::npos) return true;
    return std::find(parts.begin(), parts.end(), "..") != parts.end();
}

/// The entry of `folder` called `part`, in other upper and lower case if need be; the first in byte order of several.
std::optional<fs::path> entry(const fs::path& folder, const std::string& part) {
    std::error_code error;
    if (fs::exists(folder / part, error)) return folder / part;
    std::optional<fs::path> best;
    for (fs::directory_iterator item(folder, error), end; !error && item != end; item.increment(error)) {
        const fs::path& path = item->path();
        if (lower(path.filename().string()) == lower(part) && (!best || path < *best)) best = path;
    }
    return best;
}

/// Where links lead in the end.
bool lies_below(const fs::path& file, const fs::path& folder) {
    std::error_code error;
    const fs::path end = fs::canonical(file, error);
    if (error) return false;
    const fs::path from = end.lexically_relative(fs::canonical(folder, error));
    return !error && !from.empty() && *from.begin() != "..";
}

}  // namespace

SideFiles::SideFiles(const fs::path& model) : folder_(model.parent_path()), model_(model.filename().string()) {
    if (folder_.empty()) folder_ = ".";
}

std::optional<fs::path> SideFiles::find(std::string_view name) {
    if (const auto known = found_.find(name); known != found_.end()) return known->second;
    std::optional<fs::path>& result = found_[std::string(name)];
    std::vector<std::string> parts = parts_of(name);
    if (parts.empty() || parts.back() == ".." || name.find('\0') != std::string_view::npos) return result;

    const bool leaves = leaves_folder(name, parts);
    if (leaves) parts = {parts.back()};
    std::string exact;
    fs::path path = folder_;
    for (const std::string& part : parts) {
        const std::optional<fs::path> next = entry(path, part);
        if (!next) return result;
        path = *next;
        exact += (exact.empty() ? "" : "/") + part;
    }
    if (!is_file(path)) return result;
    if (!lies_below(path, folder_)) {
        warnings_.push_back(
            fmt::format("{} names the file '{}', which is a link that leads out of the model's folder and is not "
                        "followed; copy the file itself there.",
                        model_, name));
        return result;
    }
    result = path;
    const std::string taken = path.lexically_relative(folder_).generic_string();
    if (leaves)
        warnings_.push_back(
            fmt::format("{} names the file '{}', which lies outside the model's folder and is not followed; "
                        "'{}' beside the model was taken instead.",
                        model_, name, taken));
    else if (taken != exact)
        warnings_.push_back(fmt::format(
            "{} names the file '{}', which is written '{}' on the disk; that one was taken.", model_, name, taken));
    return result;
}

std::string decode_uri(std::string_view uri) {
    const auto digit = [](char c) {
        if (c >= '0' && c <= '9') return c - '0';
        if (c >= 'a' && c <= 'f') return c - 'a' + 10;
        return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
    };
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
            text += static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
            i += 2;
        } else {
            text += uri[i];
        }
    }
    return text;
}

}  // namespace voxtone::io
