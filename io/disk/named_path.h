// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace voxtone::io {

/// Where `name`, as a plan or a list in `folder` writes it, leads: a backslash is a slash where nothing is called so
/// and something lies there with slashes, as Windows writes paths. Throws nothing.
[[nodiscard]] std::filesystem::path named_path(const std::filesystem::path& folder, const std::string& name);

}  // namespace voxtone::io
