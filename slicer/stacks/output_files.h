// SPDX-License-Identifier: GPL-3.0-or-later
//
// A folder for files that are written beside whatever else it holds.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace voxtone::slicer {

/// Makes the folder. Throws FileError where that cannot be, InputError where one of the files of these names is there
/// already and may not be replaced.
std::filesystem::path make_folder_for(const std::filesystem::path& folder, const std::vector<std::string>& names,
                                      bool overwrite);

}  // namespace voxtone::slicer
