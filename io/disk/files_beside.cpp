// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/files_beside.h"

#include <algorithm>
#include <system_error>

namespace fs = std::filesystem;

namespace voxtone::io {

namespace {

std::vector<fs::directory_entry> entries_of(const fs::path& folder) {
    std::vector<fs::directory_entry> entries;
    std::error_code error;
    for (auto entry = fs::directory_iterator(folder, fs::directory_options::skip_permission_denied, error);
         !error && entry != fs::directory_iterator(); entry.increment(error))
        if (!entry->path().filename().string().starts_with('.')) entries.push_back(*entry);
    std::ranges::sort(entries);
    return entries;
}

bool lies_below(const fs::path& file, const fs::path& folder) {
    const auto [in_folder, in_file] = std::ranges::mismatch(folder, file);
    return in_folder == folder.end() && in_file != file.end();
}

/// A name with a dot in front on the way from `folder` to `file`.
bool is_hidden(const fs::path& file, const fs::path& folder) {
    return std::ranges::any_of(file.lexically_relative(folder),
                               [](const fs::path& name) { return name.string().starts_with('.'); });
}

}  // namespace

std::vector<std::string> files_beside(const fs::path& folder, const FilesBesideLimits& limits) {
    std::error_code error;
    const fs::path top = fs::canonical(folder.empty() ? "." : folder, error);
    if (error) return {};
    std::vector<std::string> files;
    std::vector<fs::path> level{top}, below;
    for (std::size_t depth = 0; depth <= limits.depth && !level.empty(); ++depth, level.swap(below), below.clear())
        for (const fs::path& place : level)
            for (const fs::directory_entry& entry : entries_of(place)) {
                if (files.size() == limits.files) return files;
                const fs::file_status status = entry.symlink_status(error);
                if (error) continue;
                if (fs::is_directory(status)) below.push_back(entry.path());
                if (fs::is_regular_file(status)) files.push_back(entry.path().string());
                if (!fs::is_symlink(status)) continue;
                const fs::path target = fs::canonical(entry.path(), error);
                if (!error && lies_below(target, top) && !is_hidden(target, top) && fs::is_regular_file(target, error))
                    files.push_back(target.string());
            }
    return files;
}

}  // namespace voxtone::io
