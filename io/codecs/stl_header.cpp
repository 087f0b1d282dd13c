// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/stl_header.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "voxtone/base/error.h"

namespace voxtone::io {

void check_stl(std::span<const std::byte> bytes, const std::string& name, std::vector<std::string>& lost_colours) {
    constexpr std::size_t header = 84, facet = 50;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::uint32_t count = 0;
    if (bytes.size() >= header) std::memcpy(&count, bytes.data() + 80, 4);
    const bool fits = bytes.size() >= header && std::uint64_t{count} * facet + header <= bytes.size();
    const bool ascii =
        text.substr(0, 512).find("solid") != std::string_view::npos && text.find("facet") != std::string_view::npos;
    if (ascii && (!fits || count == 0)) return;
    if (!fits)
        throw InputError(fmt::format(
            "{} is no STL file, or it is cut short: it declares {} triangles, which need {} bytes, and has {}", name,
            count, std::uint64_t{count} * facet + header, bytes.size()));
    std::uint32_t coloured = 0, plain = 0, first = 0x10000;
    bool differ = false;
    for (std::uint32_t i = 0; i < count; ++i) {
        std::uint16_t word = 0;
        std::memcpy(&word, bytes.data() + header + i * facet + 48, 2);
        if (word == 0) continue;
        ++(word & 0x8000 ? coloured : plain);
        if (first == 0x10000) first = word;
        differ |= word != first;
    }
    const bool magics = text.substr(0, 80).find("COLOR=") != std::string_view::npos;
    if (magics || (coloured && !plain && (differ || coloured < count)))
        lost_colours.push_back(fmt::format(
            "{} seems to hold facet colours ({} style); STL has no standard for them and they are LOST. Export the "
            "model as 3MF, OBJ, PLY or GLB to keep its colours.",
            name, magics ? "Magics" : "VisCAM"));
}

}  // namespace voxtone::io
