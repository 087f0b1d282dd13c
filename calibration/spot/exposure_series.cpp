// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/exposure_series.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::calibration {
namespace {

std::optional<double> number(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value > 0 && std::isfinite(value)))
        return std::nullopt;
    return value;
}

// "2", "0.5", "1/15".
std::optional<double> seconds_of(std::string_view text) {
    const auto slash = text.find('/');
    if (slash == std::string_view::npos) return number(text);
    const auto above = number(text.substr(0, slash)), below = number(text.substr(slash + 1));
    if (!above || !below) return std::nullopt;
    return *above / *below;
}

}  // namespace

ExposureFile parse_exposure(const std::string& text) {
    const auto at = text.rfind('@');
    if (at == std::string::npos) return {text, 0};
    const auto seconds = seconds_of(std::string_view(text).substr(at + 1));
    if (!seconds || at == 0)
        throw UsageError(fmt::format("{}: behind the @ stands the exposure time in seconds, as 0.5 or 1/15", text));
    return {text.substr(0, at), *seconds};
}

std::string seconds_text(double seconds) {
    const double parts = 1 / seconds;
    if (seconds < 0.5 && std::abs(parts - std::round(parts)) < 0.005 * parts) return fmt::format("1/{:.0f} s", parts);
    return fmt::format("{:.4g} s", seconds);
}

std::vector<std::filesystem::path> names_of(std::span<const ExposureFile> files) {
    std::vector<std::filesystem::path> names;
    for (const ExposureFile& file : files) names.push_back(file.file);
    return names;
}

Exposure read_exposure(const ExposureFile& file, io::PhotographReader& reader, const Progress* progress) {
    Exposure exposure{reader.read(file.file, progress), file.seconds};
    if (exposure.photograph.coding == io::SampleCoding::srgb)
        throw InputError(
            fmt::format("{}: holds sRGB codes, of which light cannot be measured over a range this wide; give the "
                        "camera's RAW file, or a linear 16-bit TIFF or PNG made of it",
                        file.file.string()));
    exposure.photograph.coding = io::SampleCoding::linear;
    if (exposure.seconds <= 0) exposure.seconds = exposure.photograph.exposure_s;
    if (!(exposure.seconds > 0))
        throw InputError(fmt::format("{0}: does not say how long it was exposed; give the time in seconds: {0}@1/15",
                                     file.file.string()));
    return exposure;
}

void expect_dark_frame(const Exposure& lit, const Exposure& dark) {
    constexpr double same_time = 0.01;
    const io::Photograph &a = lit.photograph, &b = dark.photograph;
    if (a.width_px != b.width_px || a.height_px != b.height_px)
        throw InputError(fmt::format("{} is {} x {} pixels and its dark frame {} is {} x {}; both must be cut alike",
                                     a.name, a.width_px, a.height_px, b.name, b.width_px, b.height_px));
    if (std::abs(dark.seconds - lit.seconds) > same_time * lit.seconds)
        throw InputError(
            fmt::format("{} was exposed for {} and its dark frame {} for {}; every exposure needs a dark frame of "
                        "the same time",
                        a.name, seconds_text(lit.seconds), b.name, seconds_text(dark.seconds)));
}

}  // namespace voxtone::calibration
