// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/side_files.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <system_error>

#include <fmt/format.h>
#include <utf8proc.h>

#include "base/printable.h"
#include "base/warning.h"
#include "io/files/base64.h"
#include "io/files/read_bytes.h"

namespace voxtone::io {

namespace fs = std::filesystem;

namespace {

/// Where links lead in the end.
bool ends_below(const fs::path& file, const fs::path& folder) {
    std::error_code error;
    const fs::path end = fs::canonical(file, error);
    if (error) return false;
    const fs::path from = end.lexically_relative(fs::canonical(folder, error));
    return !error && !from.empty() && *from.begin() != "..";
}

class DiskFolder final : public ModelFolder {
public:
    [[nodiscard]] bool exists(const fs::path& path) const override {
        std::error_code error;
        return fs::exists(path, error);
    }
    [[nodiscard]] bool is_file(const fs::path& path) const override {
        std::error_code error;
        return fs::is_regular_file(path, error);
    }
    [[nodiscard]] std::vector<fs::path> entries(const fs::path& folder) const override {
        std::error_code error;
        std::vector<fs::path> found;
        for (fs::directory_iterator item(folder, error), end; !error && item != end; item.increment(error))
            found.push_back(item->path());
        return found;
    }
    [[nodiscard]] bool lies_below(const fs::path& file, const fs::path& folder) const override {
        return ends_below(file, folder);
    }
    [[nodiscard]] std::vector<std::byte> read(const fs::path& file, std::uint64_t max_bytes) const override {
        return read_bytes(file, max_bytes);
    }
};

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

/// Windows-1252 to UTF-8; what that page has no letter for stays away.
std::string from_windows_1252(std::string_view text) {
    static constexpr std::array<std::uint16_t, 32> special{
        0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
        0x2039, 0x0152, 0,      0x017d, 0,      0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
        0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0,      0x017e, 0x0178};
    std::string out;
    for (const char c : text) {
        const auto byte = static_cast<std::uint8_t>(c);
        const std::uint32_t code = byte >= 0x80 && byte < 0xa0 ? special[byte - 0x80] : byte;
        if (code == 0) continue;
        if (code < 0x80) {
            out += static_cast<char>(code);
        } else if (code < 0x800) {
            out += static_cast<char>(0xc0 | code >> 6);
            out += static_cast<char>(0x80 | (code & 0x3f));
        } else {
            out += static_cast<char>(0xe0 | code >> 12);
            out += static_cast<char>(0x80 | (code >> 6 & 0x3f));
            out += static_cast<char>(0x80 | (code & 0x3f));
        }
    }
    return out;
}

/// What stays of a name where upper and lower case, the ways to write an accent (Apple's disks take letters apart) and
/// Windows-1252 in the place of UTF-8 make no difference.
std::string folded(std::string_view name) {
    const auto* const bytes = reinterpret_cast<const utf8proc_uint8_t*>(name.data());
    constexpr auto options = static_cast<utf8proc_option_t>(UTF8PROC_STABLE | UTF8PROC_COMPOSE | UTF8PROC_CASEFOLD);
    utf8proc_uint8_t* made = nullptr;
    const utf8proc_ssize_t size = utf8proc_map(bytes, static_cast<utf8proc_ssize_t>(name.size()), &made, options);
    const std::unique_ptr<utf8proc_uint8_t, decltype(&std::free)> owner(made, std::free);
    if (size == UTF8PROC_ERROR_INVALIDUTF8) return folded(from_windows_1252(name));
    return size < 0 ? std::string(name) : std::string(reinterpret_cast<const char*>(made), std::size_t(size));
}

/// The entry of `folder` called `part`, or one that only `folded` tells apart; the first in byte order of several.
std::optional<fs::path> entry(const ModelFolder& place, const fs::path& folder, const std::string& part) {
    if (part.starts_with('.')) return std::nullopt;  // nobody's texture, and shut off (io/files/file_reader.cpp)
    if (place.exists(folder / part)) return folder / part;
    std::optional<fs::path> best;
    const std::string wanted = folded(part);
    for (const fs::path& path : place.entries(folder))
        if (folded(path.filename().string()) == wanted && (!best || path < *best)) best = path;
    return best;
}

/// How many parts of two names are the same, from behind.
std::size_t same_from_behind(const std::vector<std::string>& a, const std::vector<std::string>& b) {
    std::size_t count = 0;
    while (count < std::min(a.size(), b.size()) && folded(a[a.size() - 1 - count]) == folded(b[b.size() - 1 - count]))
        ++count;
    return count;
}

std::vector<std::string> other_readings(std::string_view name) {
    const auto trim = [](std::string_view text) {
        const std::size_t first = text.find_first_not_of(" \t\r\n");
        return first == text.npos ? std::string_view()
                                  : text.substr(first, text.find_last_not_of(" \t\r\n") + 1 - first);
    };
    std::string_view plain = trim(name);
    if (plain.size() > 1 && (plain.front() == '"' || plain.front() == '\'') && plain.back() == plain.front())
        plain = trim(plain.substr(1, plain.size() - 2));
    std::string unescaped;
    for (std::size_t i = 0; i < plain.size(); ++i)
        if (!(plain[i] == '\\' && i + 1 < plain.size() && plain[i + 1] == ' ')) unescaped += plain[i];
    const std::string_view without_end = trim(plain.substr(0, plain.find_last_not_of(";,") + 1));
    const std::string_view without_query = plain.substr(0, plain.find('?'));  // of a web address
    return {std::string(plain), unescaped, decode_uri(plain), std::string(without_end), decode_uri(without_query)};
}

}  // namespace

const ModelFolder& disk_folder() {
    static const DiskFolder disk;
    return disk;
}

SideFiles::SideFiles(const fs::path& model, const ModelFolder& place)
    : place_(place), folder_(model.parent_path()), model_(model.filename().string()) {
    if (folder_.empty()) folder_ = ".";
}

std::optional<fs::path> SideFiles::find(std::string_view name) {
    if (const auto known = found_.find(name); known != found_.end()) return known->second;
    std::optional<fs::path> result = find_as_written(name);
    for (const std::string& other : other_readings(name)) {
        if (result) break;
        if (other == name || !(result = find_as_written(other))) continue;
        warnings_.push_back(named_warning("side-file", fmt::format("{} names the file '{}'; '{}' was taken for it.",
                                                                   model_, printable(name), printable(other))));
    }
    if (!result) result = find_elsewhere(name);
    if (!result) result = find_last_part(name);
    for (const std::string& other : other_readings(name))
        if (!result) result = find_last_part(other);
    return found_[std::string(name)] = result;
}

std::optional<fs::path> SideFiles::find_as_written(std::string_view name) {
    std::optional<fs::path> result;
    std::vector<std::string> parts = parts_of(name);
    if (parts.empty() || parts.back() == ".." || name.find('\0') != std::string_view::npos) return result;

    const bool leaves = leaves_folder(name, parts);
    if (leaves) {
        if (const auto inside = find_from_root(name, parts)) return inside;
        parts = {parts.back()};
    }
    std::string exact;
    for (const std::string& part : parts) exact += (exact.empty() ? "" : "/") + part;
    const std::optional<fs::path> walked = walk(folder_, parts);
    if (!walked) return result;
    const fs::path& path = *walked;
    if (!place_.lies_below(path, folder_)) {
        warnings_.push_back(named_warning(
            "side-file",
            fmt::format("{} names the file '{}', which is a link that leads out of the model's folder and is not "
                        "followed; copy the file itself there.",
                        model_, name)));
        return result;
    }
    result = path;
    const std::string taken = path.lexically_relative(folder_).generic_string();
    if (leaves)
        warnings_.push_back(named_warning(
            "side-file",
            fmt::format("{} names the file '{}', which lies outside the model's folder and is not followed; "
                        "'{}' beside the model was taken instead.",
                        model_, name, taken)));
    else if (taken != exact)
        warnings_.push_back(named_warning(
            "side-file", fmt::format("{} names the file '{}', which is written '{}' on the disk; that one was taken.",
                                     model_, printable(name), printable(taken))));
    return result;
}

std::optional<fs::path> SideFiles::walk(const fs::path& from, const std::vector<std::string>& parts) const {
    fs::path path = from;
    for (const std::string& part : parts) {
        const std::optional<fs::path> next = entry(place_, path, part);
        if (!next) return std::nullopt;
        path = *next;
    }
    return place_.is_file(path) ? std::optional(path) : std::nullopt;
}

/// Of a name with "..", where that leads to what came with the model.
std::optional<fs::path> SideFiles::find_from_root(std::string_view name, const std::vector<std::string>& parts) {
    const bool rooted = name.starts_with('/') || name.starts_with('\\') || name.find(':') != name.npos;
    if (rooted || place_.all_files().empty()) return std::nullopt;
    std::vector<std::string> steps = parts_of(folder_.generic_string());
    for (const std::string& part : parts) {
        if (part != "..")
            steps.push_back(part);
        else if (steps.empty())
            return std::nullopt;
        else
            steps.pop_back();
    }
    return walk({}, steps);
}

std::optional<fs::path> SideFiles::find_elsewhere(std::string_view name) {
    const std::vector<std::string> wanted = parts_of(name);
    std::optional<fs::path> best;
    std::size_t best_same = 0;
    for (const fs::path& file : place_.all_files()) {
        const std::size_t same = same_from_behind(wanted, parts_of(file.generic_string()));
        if (same <= best_same) continue;
        best = file;
        best_same = same;
    }
    if (best)
        warnings_.push_back(named_warning(
            "side-file", fmt::format("{} names the file '{}', which is not beside it in the archive; '{}' was taken.",
                                     model_, printable(name), printable(best->generic_string()))));
    return best;
}

std::optional<fs::path> SideFiles::find_last_part(std::string_view name) {
    const std::vector<std::string> parts = parts_of(name);
    if (parts.size() < 2 || leaves_folder(name, parts) || name.find('\0') != std::string_view::npos)
        return std::nullopt;
    const std::optional<fs::path> path = entry(place_, folder_, parts.back());
    if (!path || !place_.is_file(*path) || !place_.lies_below(*path, folder_)) return std::nullopt;
    warnings_.push_back(named_warning(
        "side-file", fmt::format("{} names the file '{}', which is not there; '{}' beside the model was taken for it.",
                                 model_, printable(name), printable(path->filename().string()))));
    return path;
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

std::optional<std::vector<std::byte>> data_of_uri(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (!uri.starts_with("data:") || comma == uri.npos) return std::nullopt;
    const std::string data = decode_uri(uri.substr(comma + 1));
    if (uri.substr(0, comma).find(";base64") != uri.npos) return base64_bytes(data);
    const auto* const first = reinterpret_cast<const std::byte*>(data.data());
    return std::vector<std::byte>(first, first + data.size());
}

}  // namespace voxtone::io
