// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/batch/job_log.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

namespace voxtone::farm {

void append_line(const std::filesystem::path& log, const std::string& line) {
    std::ofstream(log, std::ios::app) << line << '\n';
}

std::uintmax_t log_size(const std::filesystem::path& log) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(log, error);
    return error ? 0 : size;
}

std::string tail_of_log(const std::filesystem::path& log, std::uintmax_t begin) {
    constexpr std::uintmax_t most = std::uintmax_t{1} << 16;
    const std::uintmax_t size = log_size(log);
    std::ifstream in(log, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(std::max(begin, size > most ? size - most : 0)));
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string last_line(const std::filesystem::path& log, std::uintmax_t begin, std::string_view beginning) {
    const std::string text = tail_of_log(log, begin);
    const std::size_t at = ("\n" + text).rfind("\n" + std::string(beginning));
    if (at == std::string::npos) return {};
    const std::string line = text.substr(at + beginning.size());
    return line.substr(0, line.find_last_not_of(" \n") + 1);
}

std::string last_words(const std::filesystem::path& log, std::uintmax_t begin) {
    return last_line(log, begin, "voxtone: ");
}

}  // namespace voxtone::farm
