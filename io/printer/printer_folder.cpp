// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/printer/printer_folder.h"

#include <fcntl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/disk/open_file.h"
#include "io/disk/part_files.h"
#include "io/files/markup.h"
#include "io/files/whole_file.h"
#include "io/files/zip_reader.h"
#include "io/files/zip_writer.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view manifest_begin = "<script type=\"application/json\" id=\"manifest\">",
                           manifest_end = "</script>";

bool is_packed(const fs::path& target) { return target.extension() == ".zip"; }
/// The container that the printer reads, without the page.
bool is_container(const fs::path& target) { return target.extension() == ".gcvf"; }

/// A second name of the file, or where there can be none a copy.
void link_or_copy(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::create_hard_link(from, to, error);
    if (!error) return;
    error.clear();
    fs::copy_file(from, to, error);
    if (error) fail_to_write(to, "could not be written", error.value());
}

void make_folders_for(const fs::path& file) {
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error) fail_to_write(file.parent_path(), "cannot be created", error.value());
}

std::string text_of(const fs::path& file) {
    const auto bytes = read_whole_file(file, most_how_to_print_bytes);
    return {bytes.begin(), bytes.end()};
}

/// The page in a folder or file that was made here; nothing where it is none.
std::optional<std::string> page_of(const fs::path& target) {
    try {
        if (fs::is_directory(target)) {
            if (!fs::is_regular_file(target / how_to_print_name)) return std::nullopt;
            return text_of(target / how_to_print_name);
        }
        if (!is_packed(target)) return std::nullopt;
        const ZipReader zip(target);
        const auto index = zip.find(std::string(how_to_print_name));
        if (!index) return std::nullopt;
        const auto bytes = zip.read(*index, most_how_to_print_bytes);
        return std::string(bytes.begin(), bytes.end());
    } catch (const Error&) {
        return std::nullopt;
    }
}

/// Nothing but what is made here lies in it.
bool is_printer_folder(const fs::path& folder) {
    constexpr std::array ours{how_to_print_name, layers_name, gcvf_name, resin_folder_name};
    if (!page_of(folder)) return false;
    const fs::directory_iterator entries(folder);
    return std::all_of(begin(entries), end(entries), [&](const fs::directory_entry& entry) {
        return std::find(ours.begin(), ours.end(), entry.path().filename().string()) != ours.end();
    });
}

/// A file is a GCVF by what its container must hold.
bool is_gcvf(const fs::path& file) {
    try {
        return fs::is_regular_file(file) && ZipReader(file).find("ConfigFile.xml").has_value();
    } catch (const Error&) {
        return false;
    }
}

bool same_bytes(const fs::path& one, const fs::path& other) {
    if (!fs::is_regular_file(one) || !fs::is_regular_file(other)) return false;
    if (fs::equivalent(one, other)) return true;
    if (fs::file_size(one) != fs::file_size(other)) return false;
    std::ifstream a(one, std::ios::binary), b(other, std::ios::binary);
    return std::equal(std::istreambuf_iterator<char>(a), {}, std::istreambuf_iterator<char>(b));
}

bool holds_this(const fs::path& out, const fs::path& target) {
    if (is_container(target)) return same_bytes(out / printer_folder_name / gcvf_name, target);
    const std::optional<std::string> page = page_of(out / printer_folder_name);
    return page && page == page_of(target);
}

bool is_empty_folder(const fs::path& target) { return fs::is_directory(target) && fs::is_empty(target); }

bool lies_in(const fs::path& folder, const fs::path& target) {
    const fs::path outer = fs::weakly_canonical(folder), inner = fs::weakly_canonical(target);
    return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

/// Files under the folder, in an order that is always the same.
std::vector<fs::path> files_under(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path().lexically_relative(folder));
    std::sort(files.begin(), files.end());
    return files;
}

void pack(const fs::path& folder, const fs::path& target, const Progress* progress) {
    std::vector<ZipEntry> entries;
    std::uint64_t bytes = 0;
    for (const fs::path& file : files_under(folder)) {
        entries.push_back(
            {.name = file.generic_string(), .file = folder / file, .deflate = file.extension() == ".html"});
        bytes += fs::file_size(folder / file);
    }
    expect_disk_space(target.has_parent_path() ? target.parent_path() : ".", bytes, "the ZIP for the printer");
    write_zip(target, entries, progress);
}

/// In the place of what is there, which goes last: at every moment one of the two has the name. Where a file system
/// cannot exchange two folders, the old one is away for a moment.
void rename_over(const fs::path& made, const fs::path& target) {
    if (!fs::exists(target)) return fs::rename(made, target);
    if (renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) {
        fs::remove_all(made);
        return;
    }
    const fs::path old = made.string() + ".old";
    fs::rename(target, old);
    fs::rename(made, target);
    fs::remove_all(old);
}

void copy_container(const fs::path& folder, const fs::path& target) {
    if (!fs::exists(folder / gcvf_name))
        throw InputError(
            fmt::format("--for-printer {}: {} has no GCVF file, since none was asked for: make it again with "
                        "--formats gcvf, or name a folder or a .zip file",
                        target.string(), folder.string()));
    const fs::path made = part_path(target);
    std::error_code ignored;
    fs::remove(made, ignored);
    try {
        link_or_copy(folder / gcvf_name, made);
        sync_file_system(fs::absolute(made).parent_path());
        fs::rename(made, target);
    } catch (...) {
        fs::remove(made, ignored);
        throw;
    }
}

void copy_folder(const fs::path& folder, const fs::path& target, const Progress* progress) {
    const fs::path made = part_path(target);
    try {
        fs::remove_all(made);
        std::vector<fs::path> files = files_under(folder);
        std::erase(files, fs::path(how_to_print_name));
        make_printer_folder(folder, files, made, text_of(folder / how_to_print_name), progress);
        sync_file_system(made);
        rename_over(made, target);
    } catch (...) {
        std::error_code ignored;
        fs::remove_all(made, ignored);
        throw;
    }
}

}  // namespace

bool has_hard_links(const fs::path& folder) {
    const fs::path probe = folder / part_name("link"), second = probe.string() + ".2";
    std::error_code error, ignored;
    try {
        write_staged_file(probe, std::string_view("x"));
        fs::create_hard_link(probe, second, error);
    } catch (const Error&) {
        return true;  // whoever writes there next says what is wrong
    }
    fs::remove(second, ignored);
    fs::remove(probe, ignored);
    return !error;
}

void link_files(const fs::path& from, std::span<const fs::path> files, const fs::path& into, const Progress* progress) {
    fs::path last;
    for (const fs::path& file : files) {
        if (progress) progress->check_cancelled();
        const fs::path to = into / file;
        if (to.parent_path() != last) make_folders_for(to);
        last = to.parent_path();
        link_or_copy(from / file, to);
    }
}

void make_printer_folder(const fs::path& from, std::span<const fs::path> files, const fs::path& into,
                         std::string_view page, const Progress* progress) {
    make_folders_for(into / how_to_print_name);
    link_files(from, files, into, progress);
    write_staged_file(into / how_to_print_name, page);
}

std::string manifest_for_page(std::string_view manifest) {
    return fmt::format("{}\n{}{}\n", manifest_begin, in_script(manifest), manifest_end);
}

std::optional<std::string> manifest_in_page(std::string_view page) {
    const std::size_t begin = page.rfind(manifest_begin);
    if (begin == std::string_view::npos) return std::nullopt;
    const std::string_view text = page.substr(begin + manifest_begin.size());
    const std::size_t end = text.find(manifest_end);
    if (end == std::string_view::npos) return std::nullopt;
    return std::string(text.substr(0, end));
}

void expect_printer_target(const fs::path& out, const fs::path& target, bool overwrite) {
    if (lies_in(out, target))
        throw InputError(
            fmt::format("--for-printer {}: lies in the output folder, which has {} for the printer "
                        "anyway; name a place outside of it, or leave --for-printer out",
                        target.string(), (out / printer_folder_name).string()));
    if (!fs::exists(target) || is_empty_folder(target) || holds_this(out, target)) return;
    const bool ours = fs::is_directory(target) ? is_printer_folder(target)
                      : is_container(target)   ? is_gcvf(target)
                                               : page_of(target).has_value();
    if (!ours)
        throw InputError(
            fmt::format("--for-printer {}: is there, and nothing that was made for a printer here (or "
                        "something was added to it): name another place",
                        target.string()));
    if (!overwrite)
        throw InputError(
            fmt::format("--for-printer {}: holds another print, which would be replaced: name another "
                        "place, or allow it with --overwrite",
                        target.string()));
}

bool hand_to_printer(const fs::path& out, const fs::path& target, bool overwrite, const Progress* progress) {
    const fs::path folder = out / printer_folder_name;
    if (!page_of(folder))
        throw InputError(
            fmt::format("{}: is not there, as the stack was made by a version before it: make it again "
                        "(--overwrite)",
                        folder.string()));
    expect_printer_target(out, target, overwrite);
    if (holds_this(out, target)) return false;
    make_folders_for(fs::absolute(target));
    try {
        if (is_container(target))
            copy_container(folder, target);
        else if (is_packed(target))
            pack(folder, target, progress);
        else
            copy_folder(folder, target, progress);
    } catch (const fs::filesystem_error& error) {
        throw FileError(fmt::format("--for-printer {}: could not be written ({})", target.string(), error.what()));
    }
    return true;
}

}  // namespace voxtone::io
