// SPDX-License-Identifier: GPL-3.0-or-later
//
// The words among the options: an enum for each, and what a user calls its values.
#pragma once

#include <array>

#include "base/named_values.h"
#include "halftone/loop/appearance_loop.h"
#include "optics/scene/backing.h"
#include "slicer/mesh/mesh_repair.h"
#include "slicer/options/mark_options.h"
#include "slicer/options/model_choice.h"

namespace voxtone::slicer {

/// What the separation takes a mixture to look like.
enum class Mixing {
    voxels,  ///< voxels of the printer's size, between which light finds its way
    ideal,   ///< averaged
};

/// What alpha of a model or picture means.
enum class AlphaMeaning {
    over_white,    ///< how much of a colour there is over white
    translucency,  ///< how far light gets (halftone/separation/translucency.h)
};

/// How a picture's slab is looked at.
enum class PictureView {
    front,    ///< by light that falls on it
    through,  ///< by light from behind
    both,     ///< by either, two pictures
};

enum class ScreenKind {
    blue_noise,       ///< position-addressed
    error_diffusion,  ///< three-dimensional
};

/// How far a job goes.
enum class Until : std::uint8_t {
    end,
    loop,  ///< what it came to is kept for other jobs of the body
};

enum class LoopMethod {
    automatic,  ///< by the size of the coloured surface
    descent,    ///< feedback, then along the gradient of the whole print
    feedback,   ///< each place corrects itself
};

/// Where light paths leave a body.
enum class BodyEnd {
    automatic,  ///< the mesh where it is known, else the faces of the voxels
    mesh,
    voxels,
};

/// What becomes of light that leaves a body.
enum class LightOutside {
    lost,      ///< it is gone, and light comes in everywhere as if nothing were in its way
    followed,  ///< it may meet another part of the body
};

/// Where the parts of a tray stand that the plan gives no place.
enum class Arrange : std::uint8_t {
    none,     ///< where their files' own coordinates put them
    plate,    ///< beside each other
    stacked,  ///< beside and over each other
};

/// What of a stack is predicted.
enum class PredictedView {
    automatic,  ///< top for pictures and flat boxes, else body
    top,        ///< a picture from above
    body,       ///< the whole surface
};

}  // namespace voxtone::slicer

namespace voxtone {

template <>
struct NamesOf<slicer::MarkSide> {
    using E = slicer::MarkSide;
    static constexpr auto table = std::to_array<Named<E>>({{E::unseen, "unseen"},
                                                           {E::flattest, "flattest"},
                                                           {E::front, "front"},
                                                           {E::back, "back"},
                                                           {E::left, "left"},
                                                           {E::right, "right"},
                                                           {E::top, "top"},
                                                           {E::bottom, "bottom"}});
};

template <>
struct NamesOf<slicer::Mixing> {
    using E = slicer::Mixing;
    static constexpr auto table = std::to_array<Named<E>>({{E::voxels, "voxels"}, {E::ideal, "ideal"}});
};
template <>
struct NamesOf<slicer::AlphaMeaning> {
    using E = slicer::AlphaMeaning;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::over_white, "over-white"}, {E::translucency, "translucency"}});
};
template <>
struct NamesOf<slicer::ScreenKind> {
    using E = slicer::ScreenKind;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::blue_noise, "blue-noise"}, {E::error_diffusion, "error-diffusion"}});
};
template <>
struct NamesOf<slicer::Until> {
    using E = slicer::Until;
    static constexpr auto table = std::to_array<Named<E>>({{E::end, "end"}, {E::loop, "loop"}});
};
template <>
struct NamesOf<slicer::LoopMethod> {
    using E = slicer::LoopMethod;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::automatic, "auto"}, {E::descent, "descent"}, {E::feedback, "feedback"}});
};
template <>
struct NamesOf<slicer::Arrange> {
    using E = slicer::Arrange;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::none, "none"}, {E::plate, "plate"}, {E::stacked, "stacked"}});
};
template <>
struct NamesOf<slicer::BodyEnd> {
    using E = slicer::BodyEnd;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::automatic, "auto"}, {E::mesh, "mesh"}, {E::voxels, "voxels"}});
};
template <>
struct NamesOf<slicer::LightOutside> {
    using E = slicer::LightOutside;
    static constexpr auto table = std::to_array<Named<E>>({{E::lost, "lost"}, {E::followed, "followed"}});
};
template <>
struct NamesOf<slicer::PredictedView> {
    using E = slicer::PredictedView;
    static constexpr auto table = std::to_array<Named<E>>({{E::automatic, "auto"}, {E::top, "top"}, {E::body, "body"}});
};
template <>
struct NamesOf<slicer::PictureView> {
    using E = slicer::PictureView;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::front, "front"}, {E::through, "through"}, {E::both, "both"}});
};
template <>
struct NamesOf<slicer::RepairMode> {
    using E = slicer::RepairMode;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::off, "off"}, {E::automatic, "auto"}, {E::fill, "fill"}, {E::wrap, "wrap"}});
};
template <>
struct NamesOf<slicer::CavityMode> {
    using E = slicer::CavityMode;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::automatic, "auto"}, {E::keep, "keep"}, {E::fill, "fill"}});
};
template <>
struct NamesOf<halftone::Intent> {
    using E = halftone::Intent;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::relative, "relative"}, {E::absolute, "absolute"}, {E::contrast, "contrast"}});
};
template <>
struct NamesOf<optics::Backing> {
    using E = optics::Backing;
    static constexpr auto table =
        std::to_array<Named<E>>({{E::black, "black"}, {E::white, "white"}, {E::none, "none"}});
};

}  // namespace voxtone
