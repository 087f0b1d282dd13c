// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/file_reader.h"

#include <fmt/format.h>

#include "voxtone/base/error.h"
#include "voxtone/io/files/helper_program.h"
#include "voxtone/io/files/packed_values.h"
#include "voxtone/io/files/sandbox.h"

namespace voxtone::io {

namespace {

const std::string protocol = "voxtone-read 3, voxtone " VOXTONE_VERSION;

}  // namespace

std::vector<std::byte> pack(const ReadRequest& r) {
    PackedWriter writer;
    writer(protocol, r.kind, r.path, r.max_file_bytes, r.max_pixels, r.max_unpacked_bytes, r.texture, r.samples);
    return std::move(writer.bytes);
}

ReadRequest unpack_request(std::span<const std::byte> bytes) {
    PackedReader reader(bytes);
    std::string asked;
    reader(asked);
    if (asked != protocol)
        throw ResourceError(fmt::format(
            "voxtone-read is of another version ({}) than the program that asks it ({}); install voxtone again",
            protocol, asked));
    ReadRequest r;
    reader(r.kind, r.path, r.max_file_bytes, r.max_pixels, r.max_unpacked_bytes, r.texture, r.samples);
    reader.expect_end();
    return r;
}

std::unique_ptr<IsolatedProgram> start_reader(ReadKind kind, const std::filesystem::path& path,
                                              const ReadOptions& options) {
    return start_reader(path.filename().string(),
                        {kind,
                         path.string(),
                         options.max_file_bytes,
                         options.max_pixels,
                         options.max_unpacked_bytes,
                         options.texture.string(),
                         {}},
                        isolation_limits(options));
}

std::unique_ptr<IsolatedProgram> start_reader(const std::string& what, const ReadRequest& request,
                                              IsolationLimits limits) {
    if (built_with_address_sanitizer()) limits.memory_bytes = 0;
    const std::filesystem::path path(request.path);
    limits.readable = {request.path};
    if (request.kind == ReadKind::model)  // textures, libraries of materials, buffers: beside it
        limits.readable.push_back(path.has_parent_path() ? path.parent_path().string() : ".");
    if (!request.texture.empty()) limits.readable.push_back(request.texture);
    return std::make_unique<IsolatedProgram>(what, find_helper("voxtone-read"), pack(request), limits);
}

std::vector<std::byte> read_guarded(IsolatedProgram& reader, const Progress* progress,
                                    std::vector<std::string>& warnings) {
    std::vector<std::byte> bytes = reader.result(progress);
    if (std::string note = missing_walls_note(reader.missing_walls()); !note.empty())
        warnings.push_back(std::move(note));
    return bytes;
}

}  // namespace voxtone::io
