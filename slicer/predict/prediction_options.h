// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one prediction is asked for: as the user wrote it, and checked.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/named_values.h"
#include "slicer/options/model_choice.h"
#include "slicer/options/option_words.h"
#include "slicer/predict/stack_volume.h"

namespace voxtone::slicer {

/// One prediction as the user wrote it: texts, until `resolve` makes values of them.
struct PredictOptions {
    std::string stack;
    std::vector<std::string> files;  ///< .png, .exr: a slab from above; .png, .glb, .ply: a body; .html: both
    std::string model{name_of(PredictionModel::transport)};
    double cell_mm = 0.085;  ///< of the viewing grid; in [0.01, 5]
    ModelOptions quality;
    std::string light = "auto";  ///< front, behind; auto: as the job said
    std::string backing =
        "auto";  ///< black, white, none; auto: what the job said; else black under slabs, none under bodies
    std::string boundary = "auto";    ///< of light paths: mesh, voxels; auto: the mesh where the stack knows its model
    std::string outside = "lost";     ///< light that leaves one part of a body and meets another: lost, followed
    std::string view = "auto";        ///< top, body; auto: top for pictures and flat boxes
    bool overwrite = false;           ///< files that are there are replaced
    bool absolute = false;            ///< instead of relative to the white resin
    bool lit = false;                 ///< .glb: a material for lights instead of colours as they are
    std::string resins;               ///< set or file; empty: that of the job, else the printer's
    std::string illuminant;           ///< lamp, by name or file; empty: that of the job, else D65
    std::string printer, pitch;       ///< of foreign stacks
    std::vector<std::string> assign;  ///< "#rrggbb=ROLE", of foreign stacks
    bool nearest = false;             ///< of foreign stacks: other colours are the nearest of these
    double memory_gib = 0;            ///< 0: half of the machine's
    int threads = 0;                  ///< 0: one per core
};

/// A kind of file, by the end of its name.
enum class PredictedFile {
    png,   ///< a picture, for the eye
    exr,   ///< a picture, numbers
    glb,   ///< a body's vertex colours
    ply,   ///< with numbers
    html,  ///< a page to turn, probe and cut it
};

/// One prediction, checked.
struct ResolvedPrediction {
    PredictOptions requested;                       ///< for names of files and what is a number already
    std::vector<PredictedFile> kinds;               ///< of asked.files
    std::optional<std::array<double, 3>> pitch_mm;  ///< of foreign stacks
    std::vector<ColourAssignment> assign;           ///< of foreign stacks
    PredictionModel model = PredictionModel::transport;
    std::optional<bool> from_behind;       ///< what is seen by light from there; nothing: as the job said
    std::optional<BackingChoice> backing;  ///< nothing: what the job said; else black under slabs, none under bodies
    BodyEnd boundary = BodyEnd::automatic;
    LightOutside outside = LightOutside::lost;
    PredictedView view = PredictedView::automatic;
    std::uint64_t memory_bytes = 0;
    bool only_from_above = false;  ///< bodies are refused
};

/// Throws UsageError naming option, value and rule.
[[nodiscard]] ResolvedPrediction resolve(const PredictOptions& options);

/// The same for those who want no files.
[[nodiscard]] ResolvedPrediction resolve_without_files(const PredictOptions& options);

/// Throws UsageError for a file that does not show what is seen so.
void expect_files_fit(const ResolvedPrediction& job, bool from_above);

}  // namespace voxtone::slicer

template <>
struct voxtone::NamesOf<voxtone::slicer::PredictedFile> {
    using E = slicer::PredictedFile;
    static constexpr auto table = std::to_array<Named<E>>(
        {{E::png, ".png"}, {E::exr, ".exr"}, {E::glb, ".glb"}, {E::ply, ".ply"}, {E::html, ".html"}});
};
