// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/models/model_reader.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/io/files/isolate.h"
#include "voxtone/io/models/read_parts.h"
#include "voxtone/io/pictures/picture.h"

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

IsolationLimits limits_of(const ReadOptions& options) {
    return {.memory_bytes = built_with_address_sanitizer() ? 0 : options.memory_bytes, .timeout_s = options.timeout_s};
}

}  // namespace

void validate(const ReadOptions& options) {
    if (!(options.timeout_s > 0) || !std::isfinite(options.timeout_s))
        throw UsageError(
            fmt::format("the time to read a file must be a positive number of seconds, not {}", options.timeout_s));
    if (options.max_pixels == 0 || options.max_pixels > (std::uint64_t{1} << 32))
        throw UsageError(fmt::format("the limit of pixels must be between 1 and 2^32, not {}", options.max_pixels));
}

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
            name, limits_of(options), [&] { return pack(parse(path, options)); }, options.progress));
    else
        parts = parse(path, options);
    return finish_model(std::move(parts), name, options);
}

Picture read_picture(const std::filesystem::path& path, const ReadOptions& options) {
    validate(options);
    const std::string name = path.filename().string();
    const auto decode = [&] {
        return decode_image(read_bytes(path, options.max_file_bytes), name,
                            {.max_pixels = options.max_pixels, .turn_upright = true});
    };
    DecodedImage image = options.isolate
                             ? unpack_image(run_isolated(
                                   name, limits_of(options), [&] { return pack(decode()); }, options.progress))
                             : decode();
    Picture picture;
    picture.width_px = image.texels.width_px;
    picture.height_px = image.texels.height_px;
    picture.dpi_x = image.dpi_x;
    picture.dpi_y = image.dpi_y;
    picture.warnings = std::move(image.warnings);
    if (image.has_alpha) {
        picture.warnings.push_back(fmt::format("{} has transparent pixels; they were laid over white.", name));
        compose_over(image.texels, Eigen::Vector3f::Ones());
    }
    picture.texture = std::make_shared<const Texture>(std::move(image.texels), Wrap::clamp, Wrap::clamp);
    return picture;
}

}  // namespace voxtone::io
