// SPDX-License-Identifier: GPL-3.0-or-later
//
// Any layer stack -> the volume of resins that the appearance models look at.
//
// A stack of ours says everything itself: pitch, resins by role, how its bitmaps were mirrored (undone here), and in
// job.json the resin set and what lay under a picture. Of a foreign stack (a folder of PNG files, a GCVF) one has to
// say which colour is which resin, and of a folder how large a voxel is; it is cropped to the body's box
// (foreign_body.h). A colour that looks like another of the assigned resins (swapped_colours.h), one that never occurs,
// layers whose numbers are missing and files that look like layers and are none (io/pictures/picture_series.h) are
// warned about.
//
// The volume is in the model's frame: columns run along +x, rows along -y, layer 0 is the bottom.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "optics/media/resin_volume.h"
#include "optics/media/resins.h"
#include "slicer/options/option_values.h"

namespace voxtone::slicer {

/// Three lengths in mm from "42.33,84.67,27um"; a number without a unit has that of the last one, mm if that has none.
/// Throws UsageError.
[[nodiscard]] std::array<double, 3> parse_pitch_mm(const std::string& text);

/// What a colour of a foreign stack stands for.
struct ColourAssignment {
    std::array<std::uint8_t, 3> rgb{};
    std::string role;  ///< or name of a resin; "none": no material
};
/// From "#rrggbb=ROLE". Throws UsageError.
[[nodiscard]] ColourAssignment parse_assignment(const std::string& text);

/// What is known of a stack before its layers are kept.
struct StackHead {
    std::array<int, 3> size{};  ///< of the volume, voxels along x, y, z
    std::array<double, 3> pitch_mm{};
    std::uint64_t solid_voxels = 0;  ///< with a resin
    std::string resin_set;           ///< its name
    bool has_white = false;          ///< a resin with the role W
    bool of_picture = false;         ///< made by `slice` from a picture
};

struct StackVolumeOptions {
    std::string stack{};       ///< output folder, a tray's parts/NAME, folder of PNG layers, GCVF file
    std::string resins{};      ///< set or file; empty: that of the job that made the stack, else the printer's
    std::string illuminant{};  ///< lamp, by name or file; empty: that of the job, else D65
    std::string printer{};     ///< foreign stacks: the pitch of this profile, and how its bitmaps lie
    std::optional<std::array<double, 3>> pitch_mm{};  ///< foreign stacks: of columns, rows, layers
    std::vector<ColourAssignment> assign{};           ///< foreign stacks
    bool nearest = false;  ///< foreign stacks: a colour that stands for nothing is the nearest one that does
    std::uint64_t memory_bytes = ~std::uint64_t{0};  ///< the volume may take so much
    bool below_coat = false;                         ///< a picture's stack without the clear resin on top of it
    /// Hears what will be read before much is; throws to refuse it.
    std::function<void(const StackHead&)> before_reading{};
};

struct StackVolume {
    optics::ResinVolume volume;
    optics::ResinSet resins;  ///< material m is resins[m - 1]; the white resin is among them where the set has one
    int white = -1;           ///< index of the resin with the role W, or -1
    std::string illuminant;   ///< lamp that it is looked at by
    std::array<double, 3>
        corner_mm{};  ///< of the volume: in the model's frame (own) or from the bitmaps' lower left (foreign)
    std::array<double, 2> spread_mm{};     ///< how far resin runs, along the model's x and y
    bool of_picture = false;               ///< made by `slice` from a picture
    std::optional<BackingChoice> backing;  ///< what the job said of what lies under a picture
    bool from_behind = false;              ///< the job made a picture to be seen by light from behind
    int clear_layers = 0;  ///< at a picture's bottom, that the job made all of clear resin; those on top are left out
    int clear = -1;        ///< index of the resin with the role T, or -1
};

/// What white is in the place of the stack, where that is not all of one resin: white over a picture's layers of
/// clear resin.
[[nodiscard]] std::optional<optics::ResinVolume> white_print(const StackVolume& stack);

/// Throws FileError, InputError (a resin without optical data, a colour without a resin, layers of other sizes or
/// missing, a pitch that nobody told), ResourceError (more memory than allowed), Cancelled.
[[nodiscard]] StackVolume read_stack_volume(const StackVolumeOptions& options, Progress& progress);

}  // namespace voxtone::slicer
