// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which program this is. People go by the version; what is stored goes by the build, since a version lasts for many
// commits: dumps of memory are read by the build that wrote them alone, and what another one made is made anew.
#pragma once

#include <string>

namespace voxtone::io {

/// "0.2.0".
[[nodiscard]] std::string program_version();

/// 16 hexadecimal digits: a digest of all sources and data that decide what a job makes, and of the compiler (cmake/
/// write_build_digest.cmake). Two programs of one digest make the same bits of the same job.
[[nodiscard]] std::string build_digest();

/// Both, for what is stored: "0.2.0 build 0123456789abcdef".
[[nodiscard]] std::string build_identity();

}  // namespace voxtone::io
