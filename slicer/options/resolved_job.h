// SPDX-License-Identifier: GPL-3.0-or-later
//
// The door of a slice job: what the user wrote (slice_options.h), checked and turned into values, once. Behind it there
// are enums, lengths in mm, lists and "nothing" for what the job decides by itself; no text is compared again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/files/read_options.h"
#include "io/layers/layer_format.h"
#include "io/shards/shard_number.h"
#include "slicer/options/mark_options.h"
#include "slicer/options/model_choice.h"
#include "slicer/options/option_values.h"
#include "slicer/options/option_words.h"
#include "slicer/options/placement_options.h"
#include "slicer/options/slice_options.h"

namespace voxtone::slicer {

struct PictureOptions {
    /// How large it is, by the first that is above 0; none: by the picture's own resolution.
    double width_mm = 0, height_mm = 0, dpi = 0, size_mm = 0;  ///< `size_mm`: of the longer of width and height
    double thickness_mm = 4;
    bool cut_out = false;                   ///< transparent pixels are no print
    BackingChoice backing;                  ///< what lies under it
    PictureView view = PictureView::front;  ///< through: by a source behind it, and nothing lies under it
    std::string night;                      ///< both: file of the picture that light from behind shows
    [[nodiscard]] bool has_night() const { return view == PictureView::both; }
    [[nodiscard]] bool is_lit_from_behind() const { return view == PictureView::through; }
};

/// Colours, where the surface shows them.
struct ColourOptions {
    std::string core = "W";  ///< role of the resin below the shell
    double depth_mm = 1;     ///< of the shell; in (0, 10]
    double coat_mm = 0;      ///< of clear resin over it: a body's within its surface, a picture's on top of its slab
    double enclose_mm = 0;   ///< of clear resin over and under a picture's slab, instead of a coat
    [[nodiscard]] double clear_over_mm() const { return coat_mm + enclose_mm; }
    ScreenKind screen = ScreenKind::blue_noise;
    Mixing mixing = Mixing::voxels;
    AlphaMeaning alpha = AlphaMeaning::over_white;
};

/// Thickness of a picture as it is printed, mm, with what is clear over and under it.
[[nodiscard]] inline double printed_mm(const PictureOptions& picture, const ColourOptions& colour) {
    return picture.thickness_mm + colour.clear_over_mm() + colour.enclose_mm;
}

/// The appearance loop of a colour print.
struct JobLoopOptions {
    std::optional<int> iterations;  ///< most; 0: no loop; nothing: until it stops gaining, where the surface is small
    bool patient = false;           ///< for long, where there is no number
    halftone::Intent intent = halftone::Intent::relative;
    double viewing_distance_mm = 300;
    PredictionModel model = PredictionModel::transport;
    LoopMethod method = LoopMethod::automatic;
    std::filesystem::path mixtures;  ///< file that keeps what it came to
    bool mixtures_named = false;     ///< by the user: must be there, unless it is made
};

/// What is asked of a print that shows something else than colours, as far as every job wants to know.
class OtherOptions {
public:
    OtherOptions() = default;
    OtherOptions(const OtherOptions&) = default;
    OtherOptions& operator=(const OtherOptions&) = default;
    virtual ~OtherOptions() = default;

    /// How deep below the surface it is made.
    [[nodiscard]] virtual double depth_mm() const = 0;
    /// Role of the resin below that, and the option that says so.
    [[nodiscard]] virtual const std::string& core() const = 0;
    [[nodiscard]] virtual const char* core_option() const = 0;
};

/// Who predicts the print for the report, and how closely.
struct JobPredictionOptions {
    bool automatic = true;                 ///< the size of the surface decides
    std::optional<PredictionModel> model;  ///< where not automatic; nothing: none
    double cell_mm = 0.085;                ///< also of the loop
    std::uint64_t memory_bytes = 0;        ///< most to use, also by the loop
};

/// What only a tray of many parts has (slicer/plate).
struct TrayOptions {
    double gap_mm = 2;  ///< between parts whose places are not given; less joins them (slicer/plate/joined_parts.h)
    Arrange arrange = Arrange::plate;
    bool turn = false;       ///< by right angles about the vertical, where parts come to lie closer so
    int trays = 1;           ///< at most
    bool fail_fast = false;  ///< a part that fails is the end of the tray
};

/// When a print is said to look as asked: means of CIEDE2000 over its coloured surface as seen.
struct VerdictLimits {
    /// What ISO 12647-7:2016 allows a contract proof on average.
    double good = 2.5;
    /// Above 5 two colours are taken for different ones (Mokrzycki, Tatol 2011, Machine Graphics & Vision 20:383).
    double bad = 5;
};

/// One job, checked as far as that can be done without looking at a file.
struct ResolvedJob {
    /// What it was resolved from, for who writes it down: job.json, the report's table, the job's identity. Nobody else
    /// looks at it. What was left open there and is found in the printer's profile or the map is filled in.
    SliceOptions raw;

    std::string model;    ///< file
    std::string texture;  ///< file, for a mesh without pictures of its own; empty: none
    ModelKind kind = ModelKind::mesh;
    std::filesystem::path out;
    bool overwrite = false, report = true, resume = false;
    std::filesystem::path for_printer;     ///< where OUT/printer goes besides; empty: nowhere
    bool strict = false;                   ///< what needs a look first is an error, not a warning
    std::vector<io::LayerFormat> formats;  ///< empty: the printer's
    std::optional<LayerRange> layers;      ///< nothing: all
    Until until = Until::end;
    bool keep_loop = false;                ///< what the loop came to stays beside the stack
    bool sharded = false;                  ///< a part of the layers is made, to be merged
    std::optional<io::ShardNumber> shard;  ///< nothing, where sharded: as the scheduler says

    std::string printer;            ///< id or file
    std::string resins;             ///< set or file
    std::string illuminant;         ///< lamp that the print is looked at by: name or file
    std::vector<std::string> load;  ///< roles; empty: what the printer loads by default

    PlacementOptions placement;
    PictureOptions picture;
    std::vector<MarkOptions> marks;  ///< one over the other
    RepairMode repair = RepairMode::automatic;
    double sheet_mm = 0;  ///< thickness of open sheets; 0: a voxel
    CavityMode cavities = CavityMode::automatic;
    bool keep_thin = true;

    std::shared_ptr<const OtherOptions> other;  ///< null: the surface shows colours. Else see part/other_print.h
    ColourOptions colour;
    JobLoopOptions loop;
    JobPredictionOptions prediction;
    VerdictLimits verdict;
    TrayOptions tray;

    io::ReadOptions reading;  ///< limits of reading the model

    std::uint64_t seed = 1;
    int threads = 0;  ///< 0: one per core

    [[nodiscard]] bool is_picture() const { return kind == ModelKind::picture; }
    [[nodiscard]] bool shows_colours() const { return !other; }
    /// How deep the shell is in which it shows them, or what it shows instead.
    [[nodiscard]] double shell_mm() const {
        return other ? other->depth_mm() : colour.depth_mm + colour.clear_over_mm();
    }
    /// The resin below, and the option that says so.
    [[nodiscard]] const std::string& core() const { return other ? other->core() : colour.core; }
    [[nodiscard]] const char* core_option() const { return other ? other->core_option() : "core"; }
};

}  // namespace voxtone::slicer
