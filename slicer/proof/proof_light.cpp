// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_light.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/pictures/photograph.h"

namespace voxtone::slicer {

namespace {

optics::Sky from_file(const std::string& file, Progress& progress) {
    io::Photograph photo = io::read_photograph(file, &progress);
    if (photo.coding != io::SampleCoding::linear || photo.bits < 32) {
        progress.warn(named_warning(
            "flat-light",
            fmt::format("{}: a picture of codes cannot hold how bright lamps and windows are, so its light is too "
                        "even; give an EXR",
                        file)));
        if (photo.coding == io::SampleCoding::srgb) make_linear(photo);
    }
    if (photo.width_px != 2 * photo.height_px)
        throw InputError(
            fmt::format("{}: {} x {} pixels; a lat-long picture of all directions is twice as wide as it is high", file,
                        photo.width_px, photo.height_px));
    const std::size_t width = photo.width_px, height = photo.height_px;
    std::vector<optics::Light> radiance(width * height);
    double sum = 0;
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            // A picture from within runs the other way round; its middle is -y, three quarters of the way from +x.
            const std::size_t from_right = width - 1 - x, column = (from_right + width / 4) % width;
            const Eigen::Vector3f& pixel = photo.pixels[y * width + x];
            optics::Light& light = radiance[y * width + column];
            for (std::size_t c = 0; c < 3; ++c) {
                const double value = pixel[static_cast<int>(c)];
                light[c] = std::isfinite(value) ? std::max(0.0, value) : 0.0;
            }
            if (y < height / 2) sum += optics::luminance(light);
        }
    if (!(sum > 0)) throw InputError(fmt::format("{}: all is dark above its horizon; nothing would be lit", file));
    return optics::Sky(width, height, std::move(radiance)).normalised();
}

optics::Sky preset(ProofLight light) {
    switch (light) {
        case ProofLight::studio:
            return optics::studio_sky();
        case ProofLight::overcast:
            return optics::overcast_sky();
        case ProofLight::behind:  // turned to the camera where it is taken
            return optics::Sky(1, 2, {optics::Light{1, 1, 1}, optics::Light{0, 0, 0}});
        case ProofLight::even:
        case ProofLight::edge:
        case ProofLight::slit:
        case ProofLight::spot:
        case ProofLight::laser:
            return optics::even_sky();
    }
    return optics::even_sky();
}

}  // namespace

optics::Sky light_of(const ProofLamp& lamp, double turn_deg, Progress& progress) {
    optics::Sky sky = lamp.kind ? preset(*lamp.kind) : from_file(lamp.words, progress);
    return turn_deg == 0 ? sky : sky.turned(turn_deg);
}

}  // namespace voxtone::slicer
