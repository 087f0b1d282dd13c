// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/codecs/decode_device_profile.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <lcms2.h>

#include "base/error.h"
#include "base/printable.h"
#include "io/files/deflate.h"
#include "io/files/zip_reader.h"

namespace voxtone::io {

namespace {

using OpenProfile = std::unique_ptr<void, decltype([](void* p) { cmsCloseProfile(p); })>;
using ColourTransform = std::unique_ptr<void, decltype([](void* t) { cmsDeleteTransform(t); })>;

constexpr std::size_t header_bytes = 128;  // ICC.1:2022, 7.2
constexpr std::size_t most_text_bytes = std::size_t{64} << 20;
constexpr std::uint32_t most_channels = 15;

std::uint32_t big_endian(std::span<const std::byte> bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
    return value;
}

std::string signature_text(std::uint32_t signature) {
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(signature >> shift & 0xff);
    return printable(text);
}

void check_icc_header(std::span<const std::byte> bytes, const std::string& name) {
    if (bytes.size() < header_bytes + 4 || big_endian(bytes, 36) != cmsMagicNumber)
        throw InputError(fmt::format(
            "{} is no ICC profile; give the .icc or .icm file that the software of the printer uses.", name));
    if (const std::uint32_t declared = big_endian(bytes, 0); declared > bytes.size())
        throw InputError(
            fmt::format("{} is cut short: it has {} bytes of the {} that it should have; copy or download it again.",
                        name, bytes.size(), declared));
}

OpenProfile open_profile(std::span<const std::byte> bytes, const std::string& name) {
    check_icc_header(bytes, name);
    OpenProfile profile(cmsOpenProfileFromMem(bytes.data(), static_cast<cmsUInt32Number>(bytes.size())));
    if (!profile)
        throw InputError(
            fmt::format("{} is a damaged ICC profile: its list of contents cannot be read; get another copy.", name));
    return profile;
}

DeviceTable table_of(cmsHPROFILE profile) {
    if (cmsIsTag(profile, cmsSigAToB1Tag) || cmsIsTag(profile, cmsSigDToB1Tag)) return DeviceTable::colorimetric;
    return cmsIsTag(profile, cmsSigAToB0Tag) ? DeviceTable::perceptual : DeviceTable::none;
}

std::array<double, 3> media_white_of(cmsHPROFILE profile) {
    const void* tag = cmsReadTag(profile, cmsSigMediaWhitePointTag);
    const cmsCIEXYZ white = tag ? *static_cast<const cmsCIEXYZ*>(tag) : *cmsD50_XYZ();
    return {white.X, white.Y, white.Z};
}

std::string description_of(cmsHPROFILE profile) {
    char text[256] = {};
    cmsGetProfileInfoASCII(profile, cmsInfoDescription, "en", "US", text, sizeof text);
    text[sizeof text - 1] = 0;
    return printable(text);
}

std::vector<std::byte> tag_bytes(cmsHPROFILE profile, cmsTagSignature tag) {
    if (!cmsIsTag(profile, tag)) return {};
    std::vector<std::byte> bytes(std::min<std::size_t>(cmsReadRawTag(profile, tag, nullptr, 0), most_text_bytes));
    bytes.resize(cmsReadRawTag(profile, tag, bytes.data(), static_cast<cmsUInt32Number>(bytes.size())));
    return bytes;
}

std::string as_text(std::span<const std::byte> bytes) {
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text.substr(0, text.find('\0'));
}

bool begins_with(std::span<const std::byte> bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

std::optional<std::string> unzipped(std::span<const std::byte> bytes) {
    try {
        if (begins_with(bytes, "PK")) {
            const ZipReader archive(bytes, "CxF", {.part_bytes = most_text_bytes, .total_bytes = most_text_bytes});
            if (archive.names().empty()) return std::nullopt;
            const auto part = archive.read(0, most_text_bytes);
            return as_text(std::as_bytes(std::span(part)));
        }
        return as_text(inflated_up_to(bytes, most_text_bytes));
    } catch (const InputError&) {
        return std::nullopt;
    }
}

// A tag's type and four empty bytes stand before its text. Types that zip it (zut8, ZXML) put its size before it, or
// not.
std::string measurement_text(std::span<const std::byte> tag) {
    constexpr std::size_t type_bytes = 8, size_bytes = 4;
    if (tag.size() <= type_bytes) return {};
    const std::string type = signature_text(big_endian(tag, 0));
    const std::span<const std::byte> body = tag.subspan(type_bytes);
    if (type == "text" || type == "utf8" || begins_with(body, "<") || begins_with(body, "\xEF\xBB\xBF"))
        return as_text(body);
    if (auto text = unzipped(body)) return *std::move(text);
    if (body.size() > size_bytes)
        if (auto text = unzipped(body.subspan(size_bytes))) return *std::move(text);
    return {};
}

std::vector<MeasurementText> measurements_of(cmsHPROFILE profile) {
    constexpr auto cxf = static_cast<cmsTagSignature>(0x43784620);  // "CxF "
    std::vector<MeasurementText> texts;
    for (const cmsTagSignature tag : {cxf, cmsSigCharTargetTag})
        if (std::string text = measurement_text(tag_bytes(profile, tag)); !text.empty())
            texts.push_back({signature_text(tag), std::move(text)});
    return texts;
}

ColourTransform transform_to_lab(cmsHPROFILE profile, std::uint32_t channels, cmsUInt32Number intent) {
    // No colour space in the format: Little CMS counts inks of some spaces in percent, and those of others not.
    const cmsUInt32Number device = FLOAT_SH(1) | COLORSPACE_SH(PT_ANY) | CHANNELS_SH(channels) | BYTES_SH(0);
    const OpenProfile lab(cmsCreateLab4Profile(nullptr));
    return ColourTransform(
        cmsCreateTransform(profile, device, lab.get(), TYPE_Lab_DBL, intent, cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE));
}

std::vector<double> colours(cmsHPROFILE profile, std::uint32_t channels, cmsUInt32Number intent,
                            std::span<const double> samples, const std::string& name) {
    const ColourTransform transform = transform_to_lab(profile, channels, intent);
    if (!transform)
        throw InputError(fmt::format(
            "{}: its table from device to colour (A2B) is damaged or for other channels; get another copy.", name));
    const std::size_t count = samples.size() / channels;
    std::vector<double> lab(3 * count);
    cmsDoTransform(transform.get(), samples.data(), lab.data(), static_cast<cmsUInt32Number>(count));
    return lab;
}

}  // namespace

DeviceProfile decode_device_profile(std::span<const std::byte> bytes, std::string name,
                                    std::span<const double> samples) {
    const OpenProfile opened = open_profile(bytes, name);
    DeviceProfile profile;
    profile.name = std::move(name);
    profile.device_class = signature_text(cmsGetDeviceClass(opened.get()));
    profile.colour_space = signature_text(cmsGetColorSpace(opened.get()));
    profile.connection_space = signature_text(cmsGetPCS(opened.get()));
    profile.description = description_of(opened.get());
    profile.channels = static_cast<std::uint32_t>(std::max(0, cmsChannelsOfColorSpace(cmsGetColorSpace(opened.get()))));
    profile.table = table_of(opened.get());
    profile.media_white = media_white_of(opened.get());
    profile.measurements = measurements_of(opened.get());
    if (samples.empty()) return profile;
    if (profile.channels == 0 || profile.channels > most_channels || samples.size() % profile.channels != 0 ||
        profile.table == DeviceTable::none)
        throw InputError(fmt::format("{}: has no colours for what was asked.", profile.name));
    profile.samples.assign(samples.begin(), samples.end());
    profile.lab_relative = colours(opened.get(), profile.channels, INTENT_RELATIVE_COLORIMETRIC, samples, profile.name);
    profile.lab_absolute = colours(opened.get(), profile.channels, INTENT_ABSOLUTE_COLORIMETRIC, samples, profile.name);
    return profile;
}

}  // namespace voxtone::io
