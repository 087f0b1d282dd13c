// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/slicer/stacks/output_files.h"

#include <system_error>

#include <fmt/format.h>

#include "voxtone/base/error.h"

namespace voxtone::slicer {

std::filesystem::path make_folder_for(const std::filesystem::path& folder, const std::vector<std::string>& names,
                                      bool overwrite) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw FileError(fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()));
    for (const std::string& name : names)
        if (!overwrite && std::filesystem::exists(folder / name))
            throw InputError(
                fmt::format("{}: is there already; give another folder, or --overwrite", (folder / name).string()));
    return folder;
}

}  // namespace voxtone::slicer
