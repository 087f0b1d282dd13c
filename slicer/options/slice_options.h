// SPDX-License-Identifier: GPL-3.0-or-later
//
// A slice job as the user wrote it. What each option is called, means and decides is declared in option_table.h.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "slicer/options/job_input.h"

namespace voxtone::slicer {

/// One job as the user wrote it: texts, until `resolve` makes values of them (resolved_job.h).
struct SliceOptions {
    std::string model;
    std::string out;
    std::string printer = "stratasys-j750-hm";
    std::string resins;              ///< set or file; empty: the printer's default
    std::string illuminant = "D65";  ///< a lamp by name, or a file
    std::vector<std::string> load;   ///< roles of the loaded resins; empty: what the printer loads by default
    std::string core = "W";

    std::string unit = "auto";
    double scale = 1;
    double size_mm = 0;  ///< 0: as the file has it
    std::string rotate;
    bool flip_x = false, flip_y = false, swap_xy = false;
    double width_mm = 0, height_mm = 0, dpi = 0;  ///< of pictures; all 0, and size_mm: as the file has it
    double thickness_mm = 4;
    bool cut_out = false;                 ///< transparent pixels are no print
    std::string texture;                  ///< file; empty: the mesh's own
    std::string texture_filter = "file";  ///< as the file says, nearest, linear
    std::string backing = "black";
    std::string view = "front";               ///< of pictures: by light from the front, or by light that comes through
    std::string night;                        ///< file, with view both
    std::vector<std::string> labels, decals;  ///< each as it is spelled (mark_words.h)

    std::string show = "colour";  ///< or what a floor above declares (table_of_shows.h)
    /// Values of the options that come with what it declares, by key, as OptionSpec::get says them; left out: the
    /// default.
    std::map<std::string, std::string, std::less<>> other;

    double gap_mm = 2;  ///< of a tray: between parts that are arranged
    std::string arrange = "plate";
    bool turn = false;
    int trays = 1;
    bool fail_fast = false;

    double depth_mm = 1;
    double coat_mm = 0;     ///< of clear resin over the colours
    double enclose_mm = 0;  ///< of clear resin over and under a picture
    std::string alpha = "over-white";
    std::string repair = "auto";
    double sheet_thickness_mm = 0;  ///< of open sheets; 0: a voxel
    std::string cavities = "auto";
    bool keep_thin = true;
    std::string screen = "blue-noise";
    std::string mixing = "voxels";  ///< what a mixture looks like: of voxels of the printer's size, or ideal (Eq. 7)
    std::uint64_t seed = 1;
    std::string layers;  ///< "a-b", inclusive; empty: all

    std::string iterations = "auto";  ///< of the appearance loop: a number, 0 for none; see job_loop.h
    std::string intent = "relative";
    double viewing_distance_mm = 300;
    std::string loop_model = "transport";
    std::string loop_method = "auto";
    bool resume = false;
    std::string mixtures;  ///< file of what the loop came to; empty: the output folder's, if there is one

    std::vector<std::string> formats;  ///< empty: the printer's default
    std::string for_printer;           ///< folder, .zip or .gcvf file, besides OUT/printer; empty: there alone
    bool overwrite = false;
    bool strict = false;
    bool report = true;
    std::string predict = "auto";  ///< model of the prediction in the report; see job_prediction.h
    double predict_cell_mm = 0.085;
    double verdict_good = 2.5, verdict_bad = 5;  ///< CIEDE2000; see VerdictLimits
    double memory_gib = 0;                       ///< of the prediction; 0: half of the machine's
    int threads = 0;
    std::string shard;          ///< "i/n"; "auto": as the scheduler says; empty: the whole
    std::string until = "end";  ///< or "loop"
    bool keep_loop = false;

    double read_memory_gib = 0;  ///< of the program that reads the model; 0: half of the machine's, 8 at most
    double read_time_s = 120;    ///< of the processor
    double read_size_gib = 2;    ///< of a file, and of all parts of a 3MF
    double read_megapixels = 268.435456;

    /// Keys that the user set, on the command line or in a job file to something else than the default: what of them
    /// would be ignored is refused (option_scope.h).
    std::vector<std::string> named;

    /// What the inputs held when the job file was written that these options come from; empty where it does not say.
    std::vector<JobInput> recorded_inputs;
};

}  // namespace voxtone::slicer
