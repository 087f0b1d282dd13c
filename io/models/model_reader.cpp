// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/models/model_reader.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/io/files/file_reader.h"
#include "voxtone/io/models/finish_model.h"
#include "voxtone/io/models/model_parts.h"
#include "voxtone/io/pictures/picture.h"

namespace voxtone::io {

namespace {

std::unique_ptr<IsolatedProgram> start(ReadKind kind, const std::filesystem::path& path, const ReadOptions& options) {
    return start_reader(path.filename().string(),
                        {kind, path.string(), options.max_file_bytes, options.max_pixels, options.max_unpacked_bytes},
                        {.memory_bytes = options.memory_bytes, .timeout_s = options.timeout_s});
}

}  // namespace

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return extension;
}

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

ModelReading::ModelReading(const std::filesystem::path& path, const ReadOptions& options)
    : name_(path.filename().string()), options_(options) {
    validate(options);
    if (!is_model_name(path))
        throw InputError(
            fmt::format("{} is no model of a known kind; OBJ, PLY, STL, glTF, GLB and 3MF can be read", name_));
    reader_ = start(ReadKind::model, path, options);
}

ModelReading::ModelReading(ModelReading&&) noexcept = default;
ModelReading& ModelReading::operator=(ModelReading&&) noexcept = default;
ModelReading::~ModelReading() = default;

ModelFile ModelReading::finish() {
    ModelParts parts = unpack_model(reader_->result(options_.progress));
    reader_.reset();
    return finish_model(std::move(parts), name_, options_.fill_gutters);
}

ModelFile read_model(const std::filesystem::path& path, const ReadOptions& options) {
    return ModelReading(path, options).finish();
}

Picture read_picture(const std::filesystem::path& path, const ReadOptions& options) {
    validate(options);
    return finish_picture(unpack_image(start(ReadKind::picture, path, options)->result(options.progress)),
                          path.filename().string());
}

Picture finish_picture(DecodedImage image, const std::string& name) {
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
