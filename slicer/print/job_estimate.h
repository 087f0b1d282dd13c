// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a job will take, said before it is done: plain values.
//
// How far they are to be trusted says docs/estimate.md, with measured figures.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "slicer/part/phase.h"
#include "slicer/printer/printing_time.h"

namespace voxtone::slicer {

struct ResinEstimate {
    std::string role;  ///< "C"
    std::string name;  ///< as the printer's software calls it
    double ml = 0;
    std::optional<double> g;      ///< where the resin set knows its density
    std::optional<double> price;  ///< where it knows what a kilogram costs too
};

/// One of the ways in which the body can be turned by right angles (orientations.h). It takes the same resins in all of
/// them, to within the rounding to voxels.
struct Orientation {
    std::string rotate;  ///< for --rotate: the job's own turn, then this one; empty: as the file has it
    std::array<double, 3> size_mm{};
    int layers = 0;
    std::uint64_t passes = 0;      ///< of the heads, over all layers; 0: not known
    bool fits = true;              ///< onto the tray, with as many layers as the printer asks for
    double under_ml = 0;           ///< air below overhanging body, which support may fill; on a grid of about 1 % of
                                   ///< the body's largest extent
    double downward_mm2 = 0;       ///< of the visible surface that lies downward
    double coloured_down_mm2 = 0;  ///< ... and is not white
    bool as_it_is = false;         ///< the job's own turn
    std::vector<std::string> front = {};  ///< as it looks from there, in letters
};

/// Which of them to take, and why.
struct OrientationAdvice {
    std::string rotate;  ///< as Orientation has it
    std::string reason;  ///< a sentence
};

struct JobEstimate {
    std::string model, printer;
    std::array<double, 3> size_mm{};            ///< of the body's box
    std::array<std::uint32_t, 3> size_px{};     ///< columns, rows, layers of the whole print
    std::uint32_t first_layer = 0, layers = 0;  ///< that are made
    double layer_um = 0;
    double surface_mm2 = 0;  ///< of the coloured surface

    double body_ml = 0;                 ///< in the layers that are made
    std::vector<ResinEstimate> resins;  ///< of layered prints empty
    std::string why_no_resins;          ///< a sentence where they are empty
    std::optional<double> g, price;     ///< of all, where every resin's is known
    std::string currency;               ///< of the prices

    PrintingTime printing = {};        ///< of the printer, for the layers that are made
    std::optional<double> support_ml;  ///< some of it: below what hangs over; nothing: not known, or of some layers

    bool loop = false;        ///< the appearance loop runs
    bool prediction = false;  ///< the print is predicted after it
    std::vector<PhaseEstimate> phases;
    std::size_t threads = 1;
    double cpu_s = 0, seconds = 0;   ///< sums over the phases
    double loop_s = 0;               ///< of the seconds, the appearance loop's
    std::uint64_t memory_bytes = 0;  ///< the most of any phase
    std::uint64_t disk_bytes = 0;    ///< most that the stack and its report take
    std::optional<std::uint64_t> free_disk_bytes;

    std::vector<std::string> warnings, notes;
    std::vector<std::string> faults = {};                  ///< of a tray's parts without which it is made
    ExitCode exit_code = ExitCode::done;                   ///< that slice would have for these
    std::vector<Orientation> orientations;                 ///< where they were asked for, the best first
    std::optional<OrientationAdvice> advised_orientation;  ///< nothing where none fits
};

}  // namespace voxtone::slicer
