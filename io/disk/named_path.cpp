// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/disk/named_path.h"

#include <algorithm>
#include <system_error>

namespace voxtone::io {

std::filesystem::path named_path(const std::filesystem::path& folder, const std::string& name) {
    const std::filesystem::path as_written = folder / name;
    if (name.find('\\') == std::string::npos) return as_written;
    std::string with_slashes = name;
    std::ranges::replace(with_slashes, '\\', '/');
    std::error_code none;
    const std::filesystem::path other = folder / with_slashes;
    return !std::filesystem::exists(as_written, none) && std::filesystem::exists(other, none) ? other : as_written;
}

}  // namespace voxtone::io
