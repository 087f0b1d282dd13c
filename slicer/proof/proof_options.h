// SPDX-License-Identifier: GPL-3.0-or-later
//
// A proof as the user asks for it, and the same checked.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/named_values.h"
#include "optics/scene/boundary.h"
#include "slicer/options/option_values.h"
#include "slicer/predict/stack_volume.h"

namespace voxtone::slicer {

/// From where the camera looks, by the side that is seen; a little from above, but for the last two.
enum class ProofView { three_quarter, front, right, back, left, top, bottom };

/// Which way of the model as printed is up where the print stands.
enum class ProofUp { z, minus_z, y, minus_y, x, minus_x };

/// Lights that come with the program: skies, and beams that light a part of what is seen.
/// `behind`: a source as wide as the sky, which the camera sees the print before.
enum class ProofLight { studio, overcast, even, behind, edge, slit, spot, laser };

struct ProofLamp {
    std::string words;
    std::optional<ProofLight> kind;  ///< nothing: a file
    [[nodiscard]] bool is_behind() const { return kind == ProofLight::behind; }
    [[nodiscard]] bool is_beam() const { return kind && *kind >= ProofLight::edge; }
};

/// How the printer leaves faces.
enum class ProofFinish {
    glossy,  ///< as jetted, and matt where support lay
    matt,    ///< support lay everywhere
};

struct ProofOptions {
    std::vector<std::string> stacks;  ///< from left to right
    std::vector<std::string> files;   ///< .png for the eye, .exr numbers
    bool overwrite = false;
    std::string view = "auto";    ///< auto: top for pictures, three-quarter for bodies
    std::string up = "z";         ///< of the model as printed
    double turn_deg = 0;          ///< of the print on its table, counter-clockwise from above
    std::string camera, look_at;  ///< "X,Y,Z" mm in the model's frame; empty: by the view
    double focal_mm = 85;         ///< for a frame of 36 mm; in [10, 2000]
    std::string size = "800x600";
    std::uint32_t samples = 64;  ///< per pixel, at least 8, in fours; with an error: the least
    double error = 0;            ///< wanted standard error of luminance, 1 is a white diffuser; 0: samples decide
    double filter_px = 0.5;      ///< sigma of the Gaussian by which a pixel gathers its light; in [0, 1]
    double exposure_ev = 0;      ///< in [-20, 20]
    /// Or a lat-long picture (EXR, PNG, TIFF). Several: as many pictures, the first on top. None: studio.
    std::vector<std::string> lights;
    double turn_light_deg = 0;             ///< counter-clockwise from above; of a beam from outside, about its place
    std::string light_at = "middle";       ///< of a beam: of what is seen, or "X,Y,Z" mm in the model's frame
    std::optional<double> light_width_mm;  ///< of a slit, a spot, a laser; in (0, 1000]; nothing: 1, 2, 1
    std::string finish = "glossy";
    std::array<double, 2> roughness{0, 0.3};         ///< alpha of GGX: of glossy and of matt faces; in [0, 0.9]
    std::string ground = "0.5";                      ///< its reflectance, or none
    std::string backing = "none";                    ///< a sheet behind each print
    bool with_target = false;                        ///< the model beside the print: a diffuser of the same finish
    std::string resins, illuminant, printer, pitch;  ///< as PredictOptions
    std::vector<std::string> assign;
    bool nearest = false;
    double memory_gib = 0;
    int threads = 0;
    std::uint64_t seed = 1;
};

struct ResolvedProof {
    ProofOptions requested;
    std::optional<ProofView> view;  ///< nothing: by the stack
    ProofUp up = ProofUp::z;
    std::optional<optics::Point> camera, look_at;
    int width_px = 0, height_px = 0;
    std::vector<ProofLamp> lamps;  ///< one at least
    std::optional<optics::Point> light_at;
    ProofFinish finish = ProofFinish::glossy;
    std::optional<double> ground;  ///< reflectance
    BackingChoice backing = optics::Backing::none;
    std::optional<std::array<double, 3>> pitch_mm;
    std::vector<ColourAssignment> assign;
    std::uint64_t memory_bytes = 0;
};

/// Throws UsageError naming option, value and rule.
[[nodiscard]] ResolvedProof resolve(const ProofOptions& options);

}  // namespace voxtone::slicer

template <>
struct voxtone::NamesOf<voxtone::slicer::ProofView> {
    using E = slicer::ProofView;
    static constexpr auto table = std::to_array<Named<E>>({{E::three_quarter, "three-quarter"},
                                                           {E::front, "front"},
                                                           {E::right, "right"},
                                                           {E::back, "back"},
                                                           {E::left, "left"},
                                                           {E::top, "top"},
                                                           {E::bottom, "bottom"}});
};
template <>
struct voxtone::NamesOf<voxtone::slicer::ProofUp> {
    using E = slicer::ProofUp;
    static constexpr auto table = std::to_array<Named<E>>(
        {{E::z, "z"}, {E::minus_z, "-z"}, {E::y, "y"}, {E::minus_y, "-y"}, {E::x, "x"}, {E::minus_x, "-x"}});
};
template <>
struct voxtone::NamesOf<voxtone::slicer::ProofLight> {
    using E = slicer::ProofLight;
    static constexpr auto table = std::to_array<Named<E>>({{E::studio, "studio"},
                                                           {E::overcast, "overcast"},
                                                           {E::even, "even"},
                                                           {E::behind, "behind"},
                                                           {E::edge, "edge"},
                                                           {E::slit, "slit"},
                                                           {E::spot, "spot"},
                                                           {E::laser, "laser"}});
};
template <>
struct voxtone::NamesOf<voxtone::slicer::ProofFinish> {
    using E = slicer::ProofFinish;
    static constexpr auto table = std::to_array<Named<E>>({{E::glossy, "glossy"}, {E::matt, "matt"}});
};
