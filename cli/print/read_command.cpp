// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "cli/print/job_options.h"
#include "cli/print/print_commands.h"
#include "cli/program/common_options.h"
#include "cli/program/console.h"
#include "io/disk/output_files.h"
#include "io/files/whole_file.h"
#include "io/models/model_reader.h"
#include "io/pictures/picture_writer.h"
#include "slicer/look/model_views.h"
#include "slicer/part/contents_text.h"
#include "slicer/part/model_contents.h"

namespace voxtone::cli {

namespace {

struct ReadArguments {
    JobArguments job;
    std::string picture;
    int picture_px = 720;
    bool overwrite = false;
    ConsoleOptions console;
};

/// Refuses before anything is read.
void expect_picture(const ReadArguments& arguments) {
    if (arguments.picture.empty()) return;
    if (arguments.job.models.size() > 1)
        throw UsageError(
            fmt::format("--picture shows one file, and {} are named; call read for each", arguments.job.models.size()));
    if (io::extension_of(arguments.picture) != "png")
        throw UsageError(fmt::format("--picture {}: is written as PNG alone; name it .png", arguments.picture));
    io::expect_outputs({arguments.picture}, arguments.overwrite);
}

void write_picture(const ReadArguments& arguments, const io::TexturedMesh& mesh, bool is_picture, Progress& progress) {
    progress.begin_stage("draw", 0);
    const io::LinearPicture views = slicer::model_views(mesh, is_picture, arguments.picture_px, &progress);
    io::write_whole_file(arguments.picture, io::png_bytes(io::encode_transparent(views)));
    progress.end_stage();
}

/// What is read of one file does not depend on the others: all are told of before the verb fails.
JobResult run(const ReadArguments& arguments, Progress& progress) {
    slicer::SliceOptions options = options_of(arguments.job);
    options.out = ".";      // nothing is written
    options.named.clear();  // among files of several kinds each takes what is its own
    expect_picture(arguments);
    slicer::MeshViewer view;
    if (!arguments.picture.empty())
        view = [&](const io::TexturedMesh& mesh, bool is_picture) {
            write_picture(arguments, mesh, is_picture, progress);
        };
    std::vector<slicer::ModelContents> files;
    for (const std::string& file : arguments.job.models) {
        options.model = file;
        files.push_back(slicer::read_contents(options, progress, view));
    }
    const auto failed = std::ranges::find_if(files, [](const auto& of) { return !of.error.empty(); });
    return {slicer::contents_json(files), slicer::contents_text(files),
            failed == files.end() ? ExitCode::done : failed->exit_code};
}

}  // namespace

Verb read_verb() {
    auto arguments = std::make_shared<ReadArguments>();
    Verb command(
        "read",
        "Say what is in models and pictures: format, unit, size, parts, triangles, textures, colours, materials, and "
        "the warnings that reading them gives. Nothing else is done; a file that cannot be read does not keep the "
        "others from being told",
        "cow.obj logo.png");
    arguments->job.takes_many = true;
    add_some_job_options(command, arguments->job,
                         {"model", "printer", "unit", "size", "scale", "width", "height", "dpi", "thickness", "cut-out",
                          "rotate", "texture", "read-memory", "read-time", "read-size", "read-pixels"});
    Option& model = *std::ranges::find(command.options, "model,--model", &Option::names);
    model.rules.required = true;
    model.help =
        "textured meshes (OBJ, PLY, STL, glTF, GLB, 3MF, FBX, VRML, or a ZIP of one) and pictures; what is in a plan "
        "of many `voxtone estimate` tells";
    command.add("--picture", arguments->picture,
                "a PNG to know the model by: from front, right and above, from the front, from above; of a "
                "picture, itself",
                {.unit = "FILE"});
    command.add("--picture-width", arguments->picture_px, "its width at most",
                {.unit = "PX", .range = {slicer::least_views_px, slicer::most_views_px}});
    add_overwrite_option(command, arguments->overwrite);
    arguments->console.answers = true;
    add_console_options(command, arguments->console);
    command.run = [arguments] {
        return run_on_console(arguments->console, [&](Progress& progress) { return run(*arguments, progress); });
    };
    return command;
}

}  // namespace voxtone::cli
