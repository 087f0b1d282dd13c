// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/decoders/cmyk_to_srgb.h"

#include <limits>

#include <fmt/format.h>

#include "base/warning.h"
#include "io/decoders/icc_to_srgb.h"

namespace voxtone::io {

namespace {

template <class Value>
void by_plain_rule(std::span<Value> pixels) {
    constexpr std::uint64_t most = std::numeric_limits<Value>::max();
    for (std::size_t i = 0; i + 3 < pixels.size(); i += 4) {
        const std::uint64_t paper = most - pixels[i + 3];
        for (std::size_t c = i; c < i + 3; ++c)
            pixels[c] = static_cast<Value>(((most - pixels[c]) * paper + most / 2) / most);
    }
}

}  // namespace

template <class Value>
void cmyk_to_srgb(std::span<Value> pixels, std::span<const std::uint8_t> profile, const std::string& name,
                  std::vector<std::string>& warnings) {
    const std::string trouble = profile.empty() ? "it has no profile" : convert_cmyk_icc_to_srgb(profile, pixels);
    if (!trouble.empty()) {
        by_plain_rule(pixels);
        warnings.push_back(
            named_warning("picture-colours", fmt::format("The picture {} is CMYK, and {}; it was converted by a plain "
                                                         "rule, so that its colours are rough. Save it "
                                                         "as RGB to be exact.",
                                                         name, trouble)));
    }
    for (std::size_t i = 3; i < pixels.size(); i += 4) pixels[i] = std::numeric_limits<Value>::max();
}

template void cmyk_to_srgb(std::span<std::uint8_t>, std::span<const std::uint8_t>, const std::string&,
                           std::vector<std::string>&);
template void cmyk_to_srgb(std::span<std::uint16_t>, std::span<const std::uint8_t>, const std::string&,
                           std::vector<std::string>&);

}  // namespace voxtone::io
