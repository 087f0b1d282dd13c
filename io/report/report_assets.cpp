// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/report/report_assets.h"

#include <span>

#include "voxtone/base/contracts.h"
#include "voxtone/base/embedded_file.h"

namespace voxtone::embedded {
std::span<const EmbeddedFile> report_assets();
}

namespace voxtone::io {

std::string_view report_asset(std::string_view name) {
    for (const EmbeddedFile& file : embedded::report_assets())
        if (file.name == name) return file.text;
    VOXTONE_EXPECT(!"an asset of the report");
    return {};
}

std::string in_script(std::string_view json) {
    std::string result;
    result.reserve(json.size());
    for (const char c : json) {
        if (c == '<')
            result += "\\u003c";
        else
            result += c;
    }
    return result;
}

}  // namespace voxtone::io
