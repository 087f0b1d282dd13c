// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of a bench that was never built: the printed sheet with a slab on it, the bare sheet, a colour checker
// and white paper, as a camera straight above would take them; to rehearse `calibrate edge photo`, and to test it
// against a truth that is known.
//
// Across the edge a slab looks as the renderer says (edge_simulation_job.h). Simpler than the world: over crossings of
// squares the two edges count as a product, the slab's rim and the glass are drawn, not rendered. Camera: sensor.h, its
// noise of the kind of a camera with an APS-C sensor such as the paper's (Canon EOS 700D at ISO 100: about 25,000
// electrons at full scale, 14 of read noise).
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "base/progress.h"
#include "calibration/rehearsal/edge_simulation_job.h"
#include "calibration/rehearsal/sensor.h"
#include "io/pictures/photograph.h"

namespace voxtone::calibration {

struct BenchCameraOptions : Sensor {
    BenchCameraOptions() { electrons = 25000, read_noise = 5.6e-4; }
    double width_mm = 104, height_mm = 78;  ///< of what is seen
    double turn_deg = 2;                    ///< of the sheet
    double uneven = 0.01;                   ///< light lost across the 10 mm about the edge
    int scratches = 0;                      ///< light lines on the slab, about the edge

    /// Throws InputError that names the option and the rule it breaks.
    void validate() const;
};

/// How the bare sheet looks, rendered: black and white of each channel.
struct BareSheet {
    std::array<double, 3> black{}, white{};
};
[[nodiscard]] BareSheet render_bare_sheet(const EdgeSetup& setup, std::uint64_t seed);

class BenchCamera {
public:
    BenchCamera(const EdgeSetup& setup, const BareSheet& sheet, const BenchCameraOptions& options);

    /// `shot`: addresses noise and scratches.
    [[nodiscard]] io::Photograph of_checker(const CheckerChart& chart, std::uint64_t shot) const;
    [[nodiscard]] io::Photograph of_paper(std::uint64_t shot) const;
    [[nodiscard]] io::Photograph of_sheet(std::uint64_t shot) const;
    /// All values divided by `bias`; the slab is shifted by this much.
    [[nodiscard]] io::Photograph of_slab(const RenderedSlab& slab, double bias, const Eigen::Vector2d& shift_mm,
                                         std::uint64_t shot) const;

private:
    template <class Scene>
    [[nodiscard]] io::Photograph take(const Scene& scene, double gain, std::uint64_t shot) const;
    [[nodiscard]] Eigen::Vector3d sheet_at(const Eigen::Vector2d& page) const;

    EdgeSetup setup_;
    BareSheet sheet_;
    BenchCameraOptions options_;
    std::uint32_t width_px_, height_px_;
};

}  // namespace voxtone::calibration
