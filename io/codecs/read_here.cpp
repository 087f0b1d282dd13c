// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/read_here.h"

#include "voxtone/base/error.h"
#include "voxtone/io/codecs/decode_device_profile.h"
#include "voxtone/io/codecs/decode_image.h"
#include "voxtone/io/codecs/decode_photograph.h"
#include "voxtone/io/codecs/given_texture.h"
#include "voxtone/io/codecs/parse_3mf.h"
#include "voxtone/io/codecs/parse_gltf.h"
#include "voxtone/io/codecs/parse_obj.h"
#include "voxtone/io/codecs/parse_ply.h"
#include "voxtone/io/codecs/parse_stl.h"
#include "voxtone/io/files/file_reader.h"
#include "voxtone/io/files/read_bytes.h"
#include "voxtone/io/models/finish_model.h"
#include "voxtone/io/pictures/packed_image.h"

namespace voxtone::io {

namespace {

ModelParts parse_model(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string extension = extension_of(path);
    ParseContext context(path, options);
    ModelParts parts = extension == "3mf"                          ? parse_3mf(context)
                       : extension == "gltf" || extension == "glb" ? parse_gltf(context)
                       : extension == "obj"                        ? parse_obj(context)
                       : extension == "ply"                        ? parse_ply(context)
                                                                   : parse_stl(context);
    if (!options.texture.empty()) lay_given_texture(parts, context, options.texture);
    parts.side_files = context.side_files();
    return parts;
}

DecodedImage decode_picture(const std::filesystem::path& path, const ReadOptions& options) {
    return decode_image(read_bytes(path, options.max_file_bytes), path.filename().string(),
                        {.max_pixels = options.max_pixels, .turn_upright = true});
}

}  // namespace

ModelFile read_model_here(const std::filesystem::path& path, const ReadOptions& options) {
    return finish_model(parse_model(path, options), path.filename().string(), options.fill_gutters);
}

Picture read_picture_here(const std::filesystem::path& path, const ReadOptions& options) {
    return finish_picture(decode_picture(path, options), path.filename().string());
}

std::vector<std::byte> answer(std::span<const std::byte> bytes) {
    const ReadRequest request = unpack_request(bytes);
    ReadOptions options;
    options.texture = request.texture;
    options.max_file_bytes = request.max_file_bytes;
    options.max_pixels = request.max_pixels;
    options.max_unpacked_bytes = request.max_unpacked_bytes;
    switch (request.kind) {
        case ReadKind::model:
            return pack(parse_model(request.path, options));
        case ReadKind::picture:
            return pack(decode_picture(request.path, options));
        case ReadKind::photograph:
            return pack(decode_photograph(request.path));
        case ReadKind::device_profile:
            return pack(
                decode_device_profile(read_bytes(request.path, request.max_file_bytes), request.path, request.samples));
    }
    throw InputError("what is to be read is of an unknown kind");
}

}  // namespace voxtone::io
