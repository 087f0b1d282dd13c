// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/output_files.h"

#include <unistd.h>

#include <algorithm>
#include <system_error>

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone::io {

namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

void expect_writable_folder(const fs::path& file) {
    const fs::path folder = folder_of(file);
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored))
        throw FileError(fmt::format("{}: the folder {} is not there; make it first", file.string(), folder.string()));
    if (access(folder.c_str(), W_OK | X_OK) != 0)
        throw FileError(
            fmt::format("{}: the folder {} is not writable; name another one", file.string(), folder.string()));
}

}  // namespace

void expect_outputs(const std::vector<fs::path>& files, bool overwrite) {
    for (auto file = files.begin(); file != files.end(); ++file) {
        const auto same = [&](const fs::path& other) { return other.lexically_normal() == file->lexically_normal(); };
        if (std::any_of(files.begin(), file, same))
            throw InputError(fmt::format(
                "{}: would be written twice, the second in the place of the first; give one of them another name",
                file->string()));
        std::error_code ignored;
        if (fs::is_directory(*file, ignored))
            throw FileError(fmt::format("{}: is a folder; name a file", file->string()));
        if (!overwrite && fs::exists(fs::symlink_status(*file, ignored)))
            throw InputError(
                fmt::format("{}: is there already and would be replaced; give another name, or allow it with "
                            "--overwrite",
                            file->string()));
        expect_writable_folder(*file);
    }
}

fs::path make_folder_for(const fs::path& folder, const std::vector<fs::path>& names, bool overwrite) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw FileError(fmt::format("{}: the folder cannot be made ({})", folder.string(), error.message()));
    std::vector<fs::path> files;
    for (const fs::path& name : names) files.push_back(folder / name);
    expect_outputs(files, overwrite);
    return folder;
}

}  // namespace voxtone::io
