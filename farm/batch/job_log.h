// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the processes of a job say, in a file that only grows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace voxtone::farm {

/// A log that cannot be written stops nobody.
void append_line(const std::filesystem::path& log, const std::string& line);

/// Its size now; 0: there is none.
[[nodiscard]] std::uintmax_t log_size(const std::filesystem::path& log);

/// The text of a log behind `begin`, its end if that is long.
[[nodiscard]] std::string tail_of_log(const std::filesystem::path& log, std::uintmax_t begin);

/// The last line in a log behind `begin` that begins so, and what follows it, without that beginning; empty: there is
/// none.
[[nodiscard]] std::string last_line(const std::filesystem::path& log, std::uintmax_t begin, std::string_view beginning);
/// The last message for the user in a log behind `begin` ("voxtone: ..."), without its beginning; empty: there is none.
[[nodiscard]] std::string last_words(const std::filesystem::path& log, std::uintmax_t begin);

}  // namespace voxtone::farm
