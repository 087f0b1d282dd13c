// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/camera/camera_paths.h"

#include "base/contracts.h"
#include "base/parallel.h"
#include "optics/camera/exposure.h"

namespace voxtone::optics {
namespace {

std::vector<std::uint8_t> what_is_seen(const LitScene& scene, const Progress& progress) {
    const auto width = static_cast<std::size_t>(scene.camera().width_px());
    std::vector<std::uint8_t> sees(width * static_cast<std::size_t>(scene.camera().height_px()));
    parallel_for(
        0, sees.size(), 4096,
        [&](std::size_t p) {
            const Point way = scene.camera().direction(double(p % width) + 0.5, double(p / width) + 0.5);
            sees[p] = static_cast<std::uint8_t>(scene.met(scene.camera().position(), way).what);
        },
        &progress);
    return sees;
}

}  // namespace

CameraPicture take_picture(const CameraScene& scene, const CameraOptions& options, Progress& progress) {
    VOXTONE_EXPECT(options.samples >= 2 && options.max_samples >= options.samples && options.error >= 0);
    const LitScene lit(scene);
    CameraPicture picture;
    picture.width_px = scene.view.width_px;
    picture.height_px = scene.view.height_px;
    picture.channels = lit.channels();
    picture.sees = what_is_seen(lit, progress);
    Exposure exposure(lit, options, picture);
    try {
        exposure.draw(progress);
    } catch (const Cancelled&) {
        if (!exposure.shows_all()) throw;
        picture.complete = false;
    }
    exposure.finish();
    return picture;
}

}  // namespace voxtone::optics
