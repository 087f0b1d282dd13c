// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the report's viewer carries: the surface with what is asked for and what is expected of it, some of the printed
// voxels, the places that are worst. Plain values; viewer_data.h makes text of them, data/report/viewer shows them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/layers/rgb.h"

namespace voxtone::io {

/// One colour for every place of the surface.
struct ViewerLook {
    std::string name;               ///< of a button: "target"
    std::string caption;            ///< what is seen, in a sentence's length
    std::vector<std::uint8_t> rgb;  ///< sRGB codes, three a place
};

/// A part of a picture that has a name and figures of its own: a square of a printed target.
struct ViewerPart {
    std::string name;
    std::vector<std::pair<std::string, std::string>> figures;  ///< what, how much
    std::vector<std::pair<std::size_t, double>> shares;  ///< number of a resin of the report, from 0, and its part
};

/// A difference in tenths of CIEDE2000 for every place; 255: 25.5 and more.
using ViewerDifferences = std::vector<std::uint8_t>;

/// The surface, in places that have one colour each: vertices of a body, pixels of a picture.
struct ViewerSurface {
    std::array<double, 3> low_mm{}, high_mm{};  ///< the box, in mm from the corner of the print
    double place_mm = 0;                        ///< how wide a place is, about
    std::array<std::uint32_t, 2> size_px{};     ///< of a picture: columns along +x, rows from the largest y; 0: a body
    std::vector<std::uint16_t> positions;       ///< of a body, three a vertex: 0 is low_mm, 65535 is high_mm
    std::vector<std::uint32_t> triangles;       ///< of a body, three vertices each, counter-clockwise from outside
    std::size_t clear = 0;                      ///< of a body: so many of the last of `triangles` are seen through
    std::vector<std::uint8_t> covered;          ///< of a picture: 0 where there is nothing
    std::vector<ViewerLook> looks;              ///< target first, print second where there are such
    std::string asked = "target";               ///< the looks that the probe compares, by their names
    std::string expected = "print";
    ViewerDifferences seen;              ///< from the viewing distance; may be empty
    ViewerDifferences single;            ///< place by place, before the eye blurs; may be empty
    std::vector<ViewerPart> parts;       ///< of a picture; may be empty
    std::vector<std::uint16_t> part_of;  ///< a place: the number of its part, from 1; 0: none
    bool to_scale = true;                ///< false: its mm are nothing to measure by
    std::string note;                    ///< what a place is

    [[nodiscard]] bool is_picture() const { return size_px[0] > 0; }
};

/// One layer's voxels, two a byte (the first in the low half), rows from the largest y, each row of whole bytes;
/// deflated.
struct ViewerLayer {
    std::uint32_t number = 0;  ///< of the print, 0 is the bottom
    std::vector<std::byte> deflated;
};

/// Layers that were taken for the viewer, each from the bottom up.
struct ViewerLayers {
    std::vector<ViewerLayer> thinned;  ///< some columns and rows of some layers
    std::vector<ViewerLayer> whole;
};

/// Some of the printed voxels: every step-th along each axis; besides, some layers whole.
struct ViewerVoxels {
    std::array<std::uint32_t, 3> size{};  ///< of the print: columns, rows, layers
    std::array<double, 3> pitch_mm{};
    std::array<std::uint32_t, 3> step{1, 1, 1};  ///< voxels i * step, j * step (rows from the largest y), k of `layers`
    std::vector<ViewerLayer> layers;             ///< thinned, from the bottom up, every step[2]-th from the first
    std::vector<ViewerLayer> whole;              ///< every column and row, from the bottom up
    std::string layer_file;                      ///< beside the page: "layers/slice_%05d.png"; empty: none
};

/// A place where the print differs much from what was asked for.
struct ViewerPlace {
    std::array<double, 3> at_mm{}, normal{};  ///< from the corner of the print; outward
    double seen = 0;                          ///< CIEDE2000 from the viewing distance
    Rgb target{}, print{};                    ///< as seen from there
    std::string cause;                        ///< a few words
    std::string name = {};                    ///< instead of where it is; may be empty
    std::string words = {};                   ///< where it is, as a person says it; may be empty
    double span_mm = 0;                       ///< so much of it fills the view; 0: a centimetre
};

struct ReportViewer {
    std::string heading = "What to expect";
    std::optional<ViewerSurface> surface;
    std::optional<ViewerVoxels> voxels;
    std::vector<ViewerPlace> worst;  ///< the worst first
    double viewing_distance_mm = 0;  ///< 0: nothing was seen from anywhere
    [[nodiscard]] bool empty() const { return !surface && !voxels; }
};

}  // namespace voxtone::io
