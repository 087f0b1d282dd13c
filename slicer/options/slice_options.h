// SPDX-License-Identifier: GPL-3.0-or-later
//
// Everything that a slice job can be told, in one table: the command line, the job file, `--dump-default`, `--help` and
// job.json are all made from it, so that a key means the same everywhere.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace voxtone::slicer {

/// One job. Texts stay as the user wrote them until `validate` or the job reads them.
struct SliceOptions {
    std::string model;
    std::string out;
    std::string printer = "stratasys-j750-hm";
    std::string resins = "vero-opaque";
    std::vector<std::string> load;  ///< roles of the loaded resins; empty: what the printer loads by default
    std::string core = "W";

    std::string unit = "auto";
    double scale = 1;
    double size_mm = 0;  ///< 0: as the file has it
    std::string rotate;
    bool flip_x = false, flip_y = false, swap_xy = false;
    double width_mm = 0;  ///< pictures: 0 asks for it
    double thickness_mm = 4;
    std::string backing = "black";

    std::string arrange = "colour";  ///< what is arranged: colour, or layers of the map's profiles (see job_layers.h)
    std::string profiles;            ///< file of the map
    std::string profile_placement = "uv";
    double stack_thickness_mm = 5;
    std::uint32_t stack_steps = 64, stack_blocks = 6;
    std::string stack_rounds = "auto";         ///< a number, 0 for none; auto: see job_layers.h
    std::vector<std::string> stack_materials;  ///< "ROLE=FILE"; empty: resins are computed
    double dc_weight = 1;
    std::vector<std::string> clear_top;  ///< "ROLE=LENGTH"
    std::string base = "K";              ///< role of the resin below the stacks
    double layer_smoothing_mm = 0;
    bool surfaces = false;
    double surface_cell_mm = 0.1;
    /// Layers of a map of profiles instead of colours.
    [[nodiscard]] bool layered() const { return arrange == "layered-profile"; }

    double depth_mm = 1;
    std::string repair = "auto";
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

    std::vector<std::string> formats;  ///< empty: the printer's default
    bool overwrite = false;
    bool report = true;
    std::string predict = "auto";  ///< model of the prediction in the report; see job_prediction.h
    double predict_cell_mm = 0.085;
    double memory_gib = 0;  ///< of the prediction; 0: half of the machine's
    int threads = 0;
};

/// One entry of the table.
struct OptionSpec {
    enum class Kind { text, list, number, length, flag };
    std::string key;     ///< key of the job file
    std::string option;  ///< `--option` of the command line; that of the mesh may also stand alone
    Kind kind;
    std::string metavar;               ///< "MM", "ID", "a-b"
    std::string group;                 ///< heading in --help
    std::string help;                  ///< what it does, with its unit and its choices
    std::vector<std::string> choices;  ///< empty: free
    std::function<std::string(const SliceOptions&)> get;
    /// Throws UsageError that names the key, the value and the rule.
    std::function<void(SliceOptions&, const std::string&)> set;
};

[[nodiscard]] std::span<const OptionSpec> slice_option_table();

/// Coloured surface whose resins `slice` rearranges without being asked.
inline constexpr double auto_loop_cm2 = 30;

/// Rounds of corrected searches; -1: "auto". Throws UsageError.
[[nodiscard]] int parse_stack_rounds(const std::string& text);
/// One entry of `stack_materials`. Throws UsageError.
struct StackMaterialFile {
    std::string role, file;
};
[[nodiscard]] std::vector<StackMaterialFile> parse_stack_materials(const std::vector<std::string>& entries);
/// Coloured surface up to which `--loop-method auto` goes on downhill after feedback: beyond it the same few iterations
/// gain as much by feedback alone, in half the time and three quarters of the memory (docs/benchmarks.md, "Bodies").
inline constexpr double descent_cm2 = 30;

/// Most iterations of the loop; -1: until it stops gaining ("auto"). Throws UsageError.
[[nodiscard]] int parse_iterations(const std::string& text);

/// How far from the top of any stacking a resin stays.
struct ClearTop {
    std::string role;
    double mm = 0;
};
/// Of options.clear_top. Throws UsageError.
[[nodiscard]] std::vector<ClearTop> parse_clear_top(const std::vector<std::string>& entries);

/// First and last layer that are asked for, inclusive.
struct LayerRange {
    int first = 0;
    int last = -1;
};

/// `text` "a-b" or "a" within [0, layers); empty: all. Throws InputError.
[[nodiscard]] LayerRange parse_layer_range(const std::string& text, int layers);

/// Rules between values (a depth above 0, a list without doubles, ...). Throws UsageError naming key, value and rule.
void validate(const SliceOptions& options);

/// A job file ("voxtone-job") as text, complete: every key with its value.
[[nodiscard]] std::string job_json(const SliceOptions& options);

/// Reads a job file into `options`: only the keys that it has. Unknown keys are errors that name the nearest known key.
/// Relative paths of the model, of the map of profiles and of measured materials are relative to the job file. Throws
/// FileError, InputError.
void read_job(const std::string& path, SliceOptions& options);

}  // namespace voxtone::slicer
