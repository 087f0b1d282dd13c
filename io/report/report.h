// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job has to say for itself, as plain values: the page (report_html.h) and the figures for programs
// (report_json.h) are made of it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/named_values.h"
#include "io/layers/rgb.h"
#include "io/report/viewer.h"

namespace voxtone::io {

struct ReportPicture {
    std::string caption;
    std::vector<std::uint8_t> file;  ///< PNG or WebP, transparent where there is nothing: the page has a grey stage
    std::uint32_t width_px = 0, height_px = 0;
    double px_per_mm = 0;  ///< 0: not to scale, no scale bar
};

/// What is seen from one side: usually the target and the prediction, in the same scale.
struct ReportView {
    std::string name;  ///< "front"
    std::vector<ReportPicture> pictures;
};

struct ReportLayer {
    std::uint32_t number = 0;  ///< 0 is the bottom
    double height_mm = 0;      ///< of the layer's middle above the bottom of the stack
    ReportPicture picture;     ///< all of one size
};

struct ReportResin {
    std::string name;           ///< the maker's name
    std::string role;           ///< "W"
    std::string material_name;  ///< as the printer's software calls it; may be empty
    Rgb rgb{};                  ///< its colour in the bitmaps
    std::uint64_t voxels = 0;
    double ml = 0;
    /// As it is called wherever a person reads: what the printer's software calls it.
    [[nodiscard]] const std::string& shown_name() const { return material_name.empty() ? name : material_name; }
};

/// At the printer, as far as that is known.
struct ReportPrinting {
    int passes_of_layer = 0;   ///< of the heads; 0: not known
    std::uint64_t passes = 0;  ///< over all layers
    std::optional<double> seconds;
    std::string source;
    std::optional<double> support_ml;  ///< below what hangs over
};

struct ReportStage {
    std::string name;
    double seconds = 0;
};

enum class VerdictLevel {
    unknown,  ///< nothing was predicted
    good,
    fair,
    bad,
};

/// Pieces of one flat colour, or type and lines of it, as a person sees them.
struct ReportRegion {
    /// "paper", "solid", "type and lines", "small type", "code", "label", "fine detail", "texture", "thin walls",
    /// "colour": where most is off of what has no flat areas
    std::string kind;
    std::string asked, printed = {};   ///< "red (255, 0, 0)", sRGB; of a code what it is: "QR code of 9.0 x 9.0 mm"
    std::string asked_seen = {};       ///< what the eye makes of `asked` at its size; empty: about the same
    std::array<double, 3> place_mm{};  ///< of a cell in the middle of the largest, in the print
    std::array<double, 3> normal{};    ///< outward, there
    std::string place = {};            ///< in words: "upper left front"
    std::string from = {};             ///< the side from which most of it is seen: "from below"; of a picture none
    int pieces = 1;                    ///< so many are joined
    double area_mm2 = 0;
    double seen_share = 1;                    ///< how far it can be seen, of what lies open to the sky
    std::optional<double> de2000 = {};        ///< between the means; not of type and lines that are seen by contrast
    std::optional<double> unevenness = {};    ///< of paper and solids: root mean square within it, CIEDE2000 as seen
    std::optional<double> rim = {};           ///< of a solid: mean chroma of print less target by its edge, in CIELAB
    double contrast = 0, contrast_asked = 0;  ///< of type and lines against what surrounds them, (a - b) / (a + b)
    std::optional<double> type_mm = {};       ///< of small type: size of the face below which it is not read
    bool out_of_reach = false;                ///< no mixture of the loaded resins is much nearer
    bool good = true;
    std::string why = {};  ///< what is wrong with it, a clause; empty where it is good
};

/// What might be done, tried before it is said.
struct ReportAdvice {
    std::string text;     ///< what, and what it would come to
    std::string options;  ///< as they are written: "--size 83mm"; empty: it is done to the model, or elsewhere
    std::string figure;   ///< "seen_de2000": the verdict's mean; "gamut": that of the colours out of reach; "type_mm",
                          ///< "module_mm"
    double now = 0, then = 0;
};

/// What a print's user wants to know first. Figures are CIEDE2000 over the whole coloured surface, by area and by how
/// far it can be seen.
struct ReportVerdict {
    VerdictLevel level = VerdictLevel::unknown;
    std::string sentence;                          ///< will it look as asked; what is worst; why, and what to try
    std::string headline = {}, why = {};           ///< of the sentence, for a page that has figure and advice beside it
    std::string but = {};                          ///< the worst thing on it, a sentence; may be empty
    std::array<double, 3> but_mm{}, but_normal{};  ///< where that is
    std::optional<double> seen_mean, seen_p95;     ///< the headline and its tail: as seen from the viewing distance
    std::optional<double> reach_mean;              ///< of that, what no mixture of the loaded resins could avoid
    std::optional<double> paper =
        {};                  ///< of the light that was asked for, what is taken for white; where less than all
    double wrong_share = 0;  ///< of what is seen: off by more than `bad_above`, flecked, or blurred
    double viewing_distance_mm = 0;
    double good_up_to = 0, bad_above = 0;  ///< means
    double off_share = 0;                  ///< of what is seen: differs by more than `good_up_to`
    struct Side {
        std::string name;  ///< "front"
        double mean = 0;   ///< from there
        double share = 0;  ///< of all that is seen from anywhere
    };
    std::vector<Side> sides = {};  ///< of a body; those from which hardly anything is seen are left out
    struct Cause {
        std::string name;
        double share = 0;  ///< of all that is off, by area, difference and how far it is seen
    };
    std::vector<Cause> causes;               ///< the largest first
    std::vector<ReportAdvice> advice;        ///< what to try, the best first
    std::vector<ReportRegion> regions = {};  ///< the worst first
    /// Share of the surface with a difference as seen in [edge, next edge), the last one everything above.
    std::vector<std::pair<double, double>> seen_histogram;
};

/// How the target was brought into what the loaded resins can show.
struct ReportGamut {
    double mapped_share = 0;                                 ///< of the coloured surface, in [0, 1]
    double mean_de2000 = 0, p95_de2000 = 0, max_de2000 = 0;  ///< over the whole coloured surface: asked for - mapped
};

/// What of the translucency alpha that was asked for the resins show, over the coloured surface.
struct ReportTranslucency {
    double asked_mean = 0, shown_mean = 0;
    double given_up_mean = 0, given_up_max = 0;
    double given_up_share = 0;  ///< of the surface, in [0, 1]: more is given up than an eye may tell
};

/// What an appearance model says of the print, against what was asked for; figures weigh the surface by area.
struct ReportPrediction {
    std::string model;
    std::string note;  ///< what it is and what it leaves out; one paragraph
    std::array<double, 3> cell_um{};
    std::uint64_t cells = 0;
    double seconds = 0;
    double mean_de2000 = 0, median_de2000 = 0, p95_de2000 = 0, max_de2000 = 0;
    /// Share of the surface with a difference in [edge, next edge), the last one everything above.
    std::vector<std::pair<double, double>> histogram;
};

/// One print of the appearance loop: errors against the target, over all cells, by area, CIEDE2000.
struct ReportIteration {
    int number = 0;                        ///< 0: the open loop
    double mean = 0, median = 0, p95 = 0;  ///< as seen from the viewing distance
    double cells_mean = 0;                 ///< cell by cell
    double saturated_share = 0;            ///< of the cells, at their limits, in [0, 1]
    double seconds = 0;
};

struct ReportLoop {
    std::string note;  ///< what was done and why it ended; one paragraph
    std::vector<ReportIteration> iterations;
    int best = 0;  ///< number of the one that is printed
    double seconds = 0;
    std::vector<ReportPicture> crops, sections;  ///< magnified surface; cut through the resins
    std::string sections_note;
};

/// A table of texts; cells that look like numbers are set to the right.
struct ReportTable {
    std::string title;
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
};

/// Lines on a white ground.
struct ReportDrawing {
    std::string caption;  ///< may be empty
    std::string svg;      ///< of ours (plot_svg.h): goes into the page as it is
};

struct ReportSection {
    std::string title;
    std::vector<std::string> paragraphs;
    std::vector<ReportTable> tables;
    std::vector<ReportPicture> pictures;
    std::vector<ReportDrawing> drawings;
    std::string listing = {};  ///< lines in letters of one width; may be empty
    bool printed = false;      ///< also where the page is put on paper
};

/// One of many bodies in one print.
struct ReportPart {
    std::string name, page;  ///< of its own report, seen from this one's folder; empty: none
    std::string about;       ///< whose it is and what is written on it; may be empty
    ReportPicture picture;   ///< small; without a file: none
    std::uint32_t copies = 1;
    double ml = 0;  ///< of resin, each
    VerdictLevel level = VerdictLevel::unknown;
    std::string headline;             ///< of its verdict; may be empty
    std::optional<double> seen_mean;  ///< CIEDE2000 from the viewing distance
};

/// What an option is set to, as JSON has it.
using ReportOption = std::variant<std::string, bool, std::uint64_t, double, std::vector<std::string>>;

struct Report {
    std::string title;            ///< the model's name
    std::string program_version;  ///< "0.2.0"
    std::string printer_id, printer_name;
    std::array<double, 3> pitch_um{};
    std::array<double, 3> size_mm{};         ///< of the body's box
    std::array<std::uint32_t, 3> size_px{};  ///< columns, rows, layers; no layers: the page is of no stack
    std::uint64_t body_voxels = 0;
    std::vector<ReportResin> resins;
    ReportPrinting printing;
    std::vector<std::string> warnings;
    std::vector<ReportStage> stages;  ///< one after the other
    double total_seconds = 0;         ///< of the whole job
    std::uint64_t peak_memory_bytes = 0;
    std::uint64_t output_bytes = 0;
    std::optional<ReportVerdict> verdict;  ///< of a print that shows colours
    std::optional<ReportGamut> gamut;
    std::optional<ReportTranslucency> translucency;  ///< where alpha asks for it
    std::optional<ReportPrediction> prediction;
    std::optional<ReportLoop> loop;
    std::string prediction_note;    ///< what the prediction is and what it leaves out; one paragraph
    std::vector<ReportPart> parts;  ///< the viewer's worst places are theirs then, one for each
    std::vector<ReportView> views;
    ReportViewer viewer;                  ///< stands in the place of `views` and `layers` where a browser can show it
    std::vector<ReportLayer> layers;      ///< some of them, from the bottom up
    std::vector<ReportSection> sections;  ///< whatever else there is to tell
    std::vector<std::pair<std::string, ReportOption>> job;  ///< every option as resolved
};

}  // namespace voxtone::io

template <>
struct voxtone::NamesOf<voxtone::io::VerdictLevel> {
    using Level = io::VerdictLevel;
    static constexpr auto table = std::to_array<Named<Level>>(
        {{Level::unknown, "unknown"}, {Level::good, "good"}, {Level::fair, "fair"}, {Level::bad, "bad"}});
};
