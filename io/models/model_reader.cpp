// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/models/model_reader.h"

#include <algorithm>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/io/files/isolate.h"
#include "voxtone/io/models/read_parts.h"

namespace voxtone::io {

namespace {

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return extension;
}

ModelParts parse(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string extension = extension_of(path);
    ParseContext context(path, options);
    if (extension == "3mf") return parse_3mf(context);
    if (extension == "gltf" || extension == "glb") return parse_gltf(context);
    return parse_with_assimp(context, extension);
}

}  // namespace

bool is_model_name(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    return extension == "obj" || extension == "ply" || extension == "stl" || extension == "gltf" ||
           extension == "glb" || extension == "3mf";
}

ModelFile read_model(const std::filesystem::path& path, const ReadOptions& options) {
    validate(options);
    const std::string name = path.filename().string();
    if (!is_model_name(path))
        throw InputError(
            fmt::format("{} is no model of a known kind; OBJ, PLY, STL, glTF, GLB and 3MF can be read", name));
    ModelParts parts;
    if (options.isolate)
        parts = unpack_model(run_isolated(
            name, isolation_limits(options), [&] { return pack(parse(path, options)); }, options.progress));
    else
        parts = parse(path, options);
    return finish_model(std::move(parts), name, options);
}

}  // namespace voxtone::io
