// SPDX-License-Identifier: GPL-3.0-or-later
//
// The layered half of a job (`--show layered-profile`): from a map of wanted scattering profiles to layers of resin
// wrapped around the body, in the place of colours, screens and the appearance loop.
//
// Materials are the loaded resins, known by their profiles. For each cluster of the map the best laminate of blocks is
// searched (scattering/design/laminate_search.h) and its thicknesses refined (laminate_refinement.h), under a smooth
// surface to air and over the base resin taken to be deep; what the layered model gets wrong, which takes light between
// layers as diffuse, is corrected by the same laminates in all directions (laminate_design.h,
// optics/profiles/wave_laminates.h). Or materials are measured profiles (laminate_setting.h), with the surface that
// they had, and nothing is corrected. What lies so deep that it changes what is seen by less than 2 % of the distance
// is left out (shortened_laminate.h). The laminates are aligned, interpolated to height fields over the map, and
// wrapped.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "halftone/screens/blue_noise_screen.h"
#include "io/profiles/profile_map.h"
#include "optics/numerics/hankel.h"
#include "scattering/design/aligned_laminates.h"
#include "scattering/design/laminate_design.h"
#include "scattering/design/layer_fields.h"
#include "scattering/jobs/layered_options.h"
#include "scattering/print/laminate_fit.h"
#include "scattering/print/map_placement.h"
#include "scattering/print/wrapped_layers.h"
#include "slicer/part/job_body.h"
#include "slicer/part/job_colour.h"

namespace voxtone::scattering {

/// What is printed where the map asks for one cluster.
struct ClusterLaminate {
    double share = 0;        ///< of the map's pixels
    ChannelProfiles target;  ///< Hankel coefficients, wanted
    LaminateDesign design;

    /// What is expected of the laminate, and how far that is from the target: as corrected, or by the layered model.
    [[nodiscard]] const ChannelProfiles& expected() const {
        return design.judged.empty() ? design.modelled : design.judged;
    }
    [[nodiscard]] double distance() const {
        return design.judged.empty() ? design.modelled_distance : design.judged_distance;
    }
};

/// In how many rounds laminates are corrected: as asked for, else in one; of measured materials none.
[[nodiscard]] int correcting_rounds(const LayeredOptions& options);

/// The farthest sample of any wanted profile.
[[nodiscard]] double profile_extent_mm(const io::ProfileMap& map);

/// The map where it lies on a body.
struct PlacedMap {
    LaminateMap laminates;  ///< refers to the map's pixels
    MapPlacement placement;
    std::string stretched;  ///< a warning where a map changes its shape; may be empty
};

/// A laminate for each cluster of the map.
struct DesignedLaminates {
    io::ProfileMap map;
    optics::HankelGrid grid;
    std::vector<ClusterLaminate> clusters;
    PlacedMap placed;
    bool measured = false;  ///< materials are from profile files
    double materials_s = 0, search_s = 0;
};

/// The laminates wrapped around the body. Stays where it was made; keeps references to the body.
class JobLayers {
public:
    JobLayers(DesignedLaminates designed, const slicer::JobBody& body, const slicer::LoadedResins& resins,
              Progress& progress);
    JobLayers(const JobLayers&) = delete;
    JobLayers& operator=(const JobLayers&) = delete;

    [[nodiscard]] const WrappedLayers& wrapped() const { return wrapped_; }

    io::ProfileMap map;
    optics::HankelGrid grid;
    std::vector<ClusterLaminate> clusters;
    bool measured;  ///< materials are from profile files
    double materials_s, search_s;
    AlignedLaminates aligned;
    LaminateFit fit;
    std::vector<std::string> warnings;

private:
    MapPlacement placement_;
    LayerFields fields_;
    halftone::BlueNoiseScreen screen_;
    WrappedLayers wrapped_;
};

/// Searches the laminates of a map that `check_layers` let pass, a second of one core each, and wraps them. Throws
/// InputError: profiles that send back more light than they got, a mesh without texture coordinates where they are
/// needed, a body thinner than two voxels.
[[nodiscard]] std::unique_ptr<const JobLayers> arrange_layers(const LayeredOptions& options, io::ProfileMap map,
                                                              const slicer::JobBody& body,
                                                              const slicer::LoadedResins& resins, Progress& progress);

}  // namespace voxtone::scattering
