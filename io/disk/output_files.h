// SPDX-License-Identifier: GPL-3.0-or-later
//
// The files that a verb is about to write, asked before it works: hours must not end with a folder that is not there,
// and no file goes that the user did not give up.
#pragma once

#include <filesystem>
#include <vector>

namespace voxtone::io {

/// Changes nothing on disk. Throws InputError where one of the files is there already (unless `overwrite`: whose it is
/// cannot be told, so none is replaced unasked) or is named twice, FileError where one is a folder or its folder is not
/// there or not writable.
void expect_outputs(const std::vector<std::filesystem::path>& files, bool overwrite);

/// Makes the folder for files of these names, once `expect_outputs` has nothing against them. Throws what that throws.
std::filesystem::path make_folder_for(const std::filesystem::path& folder,
                                      const std::vector<std::filesystem::path>& names, bool overwrite);

}  // namespace voxtone::io
