// SPDX-License-Identifier: GPL-3.0-or-later
//
// Files under the temporary names that whole_file.h writes them under, and what killed processes left of them: those
// whose process is gone and that nobody holds the lock of. Only this host's are looked at: not every file system
// carries locks between hosts. Containers may have one host name and see none of one another's processes, and a machine
// that was started again has others: of those that cannot be seen from here (process_space) only what has not been
// written to for an hour is taken for left.
#pragma once

#include <filesystem>
#include <string>

namespace voxtone::io {

/// ".NAME.HOST.SPACE-PID-START.part", of this process: of two containers with one host name, in both of which it is
/// process 1, too. Long names are cut, so that it is no longer than a name may be.
[[nodiscard]] std::string part_name(const std::filesystem::path& file);
[[nodiscard]] bool is_part_name(const std::string& name);

/// Removes what killed processes left of writing this file ...
void sweep_parts_of(const std::filesystem::path& file);
/// ... or any file in a folder.
void sweep_parts(const std::filesystem::path& folder);

}  // namespace voxtone::io
