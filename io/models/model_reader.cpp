// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/model_reader.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/file_reader.h"
#include "io/files/zip_reader.h"
#include "io/models/finish_model.h"
#include "io/models/model_parts.h"

namespace voxtone::io {

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return extension;
}

bool is_model_name(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return extension == "obj" || extension == "ply" || extension == "stl" || extension == "gltf" ||
           extension == "glb" || extension == "3mf" || extension == "fbx" || extension == "zip" || is_vrml_name(path);
}

bool is_vrml_name(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return extension == "wrl" || extension == "vrml" || extension == "wrz";
}

bool is_picture_name(const std::filesystem::path& path) {
    static constexpr std::array<std::string_view, 18> extensions{"png", "jpg", "jpeg", "tif", "tiff", "bmp",
                                                                 "tga", "gif", "webp", "exr", "hdr",  "ppm",
                                                                 "pgm", "pbm", "pnm",  "psd", "svg",  "svgz"};
    return std::ranges::find(extensions, extension_of(path)) != extensions.end();
}

namespace {

/// Formats that hold all that there is in one file; some name pictures beside it all the same.
bool is_one_file(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return path_in_zip(path).is_zip || extension == "stl" || extension == "ply" || extension == "3mf" ||
           extension == "glb" || extension == "fbx";
}

ModelParts read_parts(ReadKind kind, const std::filesystem::path& path, const ReadOptions& options,
                      std::vector<std::string>& warnings) {
    ModelParts parts;
    const auto read = [&](bool sees_folder) {
        read_guarded(*start_reader(kind, path, options, sees_folder), options.progress, warnings,
                     [&](PackedReader& answer) { parts = unpack_model(answer); });
    };
    if (is_one_file(path)) {
        try {
            read(false);
            return parts;
        } catch (const NeedsFolder&) {  // it names one: once more, with its folder
        }
    }
    read(true);
    return parts;
}

void expect_model(const std::filesystem::path& path, const ReadOptions& options) {
    validate(options);
    if (!is_model_name(path))
        throw InputError(fmt::format(
            "{} is no model of a known kind; OBJ, PLY, STL, glTF, GLB, 3MF, FBX and VRML can be read, and ZIP archives "
            "of these",
            path.filename().string()));
}

}  // namespace

ModelFile read_model(const std::filesystem::path& path, const ReadOptions& options) {
    ModelSources sources;
    return read_model(path, options, sources);
}

ModelFile read_model(const std::filesystem::path& path, const ReadOptions& options, ModelSources& sources) {
    expect_model(path, options);
    std::vector<std::string> warnings;
    ModelParts parts = read_parts(ReadKind::model, path, options, warnings);
    parts.warnings.insert(parts.warnings.begin(), warnings.begin(), warnings.end());
    sources.side_files.insert(sources.side_files.end(), parts.side_files.begin(), parts.side_files.end());
    sources.notes.insert(sources.notes.end(), parts.notes.begin(), parts.notes.end());
    return finish_model(std::move(parts), path.filename().string(),
                        {options.fill_gutters, options.texture_filter, options.keep_alpha});
}

std::vector<SideFile> side_files_of(const std::filesystem::path& path, const ReadOptions& options) {
    expect_model(path, options);
    std::vector<std::string> warnings;
    return read_parts(ReadKind::side_files, path, options, warnings).side_files;
}

}  // namespace voxtone::io
