// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the programs lie that voxtone is made of besides `voxtone` itself: each loads libraries that most runs do
// without.
#pragma once

#include <filesystem>
#include <string>

namespace voxtone::io {

/// Name of the environment variable of the folder where they are looked for, and nowhere else.
inline constexpr const char* helpers_variable = "VOXTONE_HELPERS";

/// The program of this name: in $VOXTONE_HELPERS if that is set; else in ../libexec/voxtone of the running program's
/// folder or in that folder; else, for programs that only link the library, where voxtone was installed. The folder
/// that it was built in is no such place: who could make that path on another machine would have his programs run
/// there. Tests and benchmarks set the variable. Throws FileError naming the places.
[[nodiscard]] std::filesystem::path find_helper(const std::string& name);

}  // namespace voxtone::io
