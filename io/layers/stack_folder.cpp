// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/layers/stack_folder.h"

#include <algorithm>
#include <string>
#include <system_error>

#include <fmt/core.h>

#include "voxtone/base/error.h"
#include "voxtone/io/files/whole_file.h"
#include "voxtone/io/layers/manifest.h"

namespace voxtone::io {
namespace {

namespace fs = std::filesystem;

/// slice_DIGITS.EXT, or what is left of writing one.
bool is_slice(std::string name) {
    if (name.starts_with(".") && name.ends_with(".part")) name = name.substr(1, name.size() - 6);
    const std::size_t dot = name.rfind('.');
    if (!name.starts_with("slice_") || dot == std::string::npos || dot == 6) return false;
    return std::all_of(name.begin() + 6, name.begin() + static_cast<std::ptrdiff_t>(dot),
                       [](char c) { return c >= '0' && c <= '9'; }) &&
           (name.substr(dot) == ".png" || name.substr(dot) == ".tif");
}

void check_no_link(const fs::path& path) {
    if (fs::is_symlink(fs::symlink_status(path)))
        throw FileError(
            fmt::format("{}: is a link; layers would be written somewhere else than in the folder you named: "
                        "remove the link or choose another folder",
                        path.string()));
}

void remove_slices(const fs::path& folder) {
    if (!fs::is_directory(folder)) return;
    for (const auto& entry : fs::directory_iterator(folder))
        if (is_slice(entry.path().filename().string())) fs::remove(entry.path());
    if (fs::is_empty(folder)) fs::remove(folder);
}

[[noreturn]] void refuse_folder(const fs::path& out, const fs::filesystem_error& error) {
    throw FileError(fmt::format("{}: cannot be made ready for a stack ({})", out.string(), error.what()));
}

}  // namespace

void require_usable_folder(const fs::path& out, bool overwrite) {
    try {
        if (!fs::exists(fs::symlink_status(out))) return;
        if (!fs::is_directory(out))
            throw InputError(fmt::format("{}: is there and is no folder; name a folder for the stack", out.string()));
        const bool ours = fs::exists(out / unfinished_name) || fs::exists(out / manifest_name);
        if (!ours && !overwrite && !fs::is_empty(out))
            throw InputError(
                fmt::format("{}: is not empty and holds no voxtone stack; files in it could be replaced: name "
                            "another folder, or allow it with --overwrite",
                            out.string()));
        if (fs::exists(out / manifest_name) && !overwrite) {
            try {
                (void)read_manifest(out / manifest_name);
            } catch (const InputError& error) {
                throw InputError(
                    fmt::format("{}: holds a manifest.json that is not of a voxtone stack ({}): name another "
                                "folder, or allow it with --overwrite",
                                out.string(), error.what()));
            }
        }
        for (const auto name : {std::string_view("layers"), resin_folder_name, manifest_name, unfinished_name,
                                gcvf_name, vdb_name, sheet_text_name, sheet_page_name})
            check_no_link(out / name);
    } catch (const fs::filesystem_error& error) {
        refuse_folder(out, error);
    }
}

void prepare_stack_folder(const fs::path& out, bool overwrite) {
    require_usable_folder(out, overwrite);
    try {
        fs::create_directories(out);
        // The mark first: from here on the folder is not whole, whatever happens.
        write_whole_file(out / unfinished_name,
                         std::string_view("This stack is being written; it is whole when manifest.json is here.\n"));
        for (const auto name : {manifest_name, gcvf_name, vdb_name, sheet_text_name, sheet_page_name}) {
            fs::remove(out / name);
            fs::remove(part_path(out / name));
        }
        remove_slices(out / "layers");
        if (fs::is_directory(out / resin_folder_name)) {
            for (const auto& entry : fs::directory_iterator(out / resin_folder_name)) {
                check_no_link(entry.path());
                remove_slices(entry.path());
            }
            if (fs::is_empty(out / resin_folder_name)) fs::remove(out / resin_folder_name);
        }
        fs::create_directories(out / "layers");
    } catch (const fs::filesystem_error& error) {
        refuse_folder(out, error);
    }
}

}  // namespace voxtone::io
