// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/file_reader.h"

#include <chrono>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/warning.h"
#include "io/disk/files_beside.h"
#include "io/files/packed_values.h"
#include "io/files/sandbox.h"
#include "io/files/zip_reader.h"
#include "io/programs/build_identity.h"
#include "io/programs/helper_program.h"

namespace voxtone::io {

namespace {

const std::string protocol = "voxtone-read 7, voxtone " + build_identity();

constexpr const char *pictures_program = "voxtone-read-pictures", *drawings_program = "voxtone-read-drawings";

/// Where libraries that set text look for fonts, and for what there is to know of them.
std::vector<std::string> font_places() {
    std::vector<std::string> places{"/etc/fonts",
                                    "/usr/share/fontconfig",
                                    "/usr/share/fonts",
                                    "/usr/local/share/fonts",
                                    "/usr/share/xml/fontconfig",
                                    "/var/cache/fontconfig"};
    if (const char* const home = std::getenv("HOME"); home && *home == '/')
        for (const char* place : {"/.fonts", "/.local/share/fonts", "/.config/fontconfig", "/.cache/fontconfig"})
            places.push_back(home + std::string(place));
    return places;
}

/// What voxtone-read may ask for while it works.
class ReaderAnswers {
public:
    ReaderAnswers(std::string what, IsolationLimits limits) : what_(std::move(what)), limits_(std::move(limits)) {
        limits_.readable.clear();
        limits_.listable.clear();
    }
    std::vector<std::byte> operator()(std::span<const std::byte> question, const Progress* progress,
                                      std::uint8_t& missing_walls) {
        switch (unpack_request(question).kind) {
            case ReadKind::folder:
                throw NeedsFolder();
            case ReadKind::other_picture:
                return decode_picture(question, progress, missing_walls);
            default:
                throw InputError(fmt::format("the reader of {} asks for what it may not have", what_));
        }
    }

private:
    std::vector<std::byte> decode_picture(std::span<const std::byte> question, const Progress* progress,
                                          std::uint8_t& missing_walls) {
        const bool is_drawing = unpack_request(question).format == drawing_format;
        std::shared_ptr<IsolatedProgram>& waiting = is_drawing ? drawings_ : pictures_;
        if (!waiting)
            waiting = is_drawing ? start_drawing(question)
                                 : std::make_shared<IsolatedProgram>(what_, find_pictures_program(), question, limits_);
        else
            waiting->post_request(question);
        const std::shared_ptr<IsolatedProgram> program = std::move(waiting);  // of no use after most errors
        program->count_as_spent(spent_s_);  // the limit of time is that of all pictures of a file
        const auto start = std::chrono::steady_clock::now();
        try {
            std::vector<std::byte> picture = program->result(progress);
            missing_walls |= program->missing_walls();
            spent_s_ = program->spent_s();
            waiting = program;
            return picture;
        } catch (const InputError&) {  // where it crashed its own clock is gone
            spent_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            throw;
        }
    }

    /// Pango looks fonts up in threads of its own.
    [[nodiscard]] std::shared_ptr<IsolatedProgram> start_drawing(std::span<const std::byte> question) const {
        IsolationLimits limits = limits_;
        limits.readable = font_places();
        limits.threads = true;
        return std::make_shared<IsolatedProgram>(what_, find_drawings_program(), question, limits);
    }

    static std::filesystem::path find_drawings_program() {
        try {
            return find_helper(drawings_program);
        } catch (const FileError&) {
            throw InputError(fmt::format(
                "SVG drawings are drawn by {}, which is not installed here: install it (the package voxtone-drawings), "
                "or save the drawing as PNG, of 300 dpi or more",
                drawings_program));
        }
    }

    static std::filesystem::path find_pictures_program() {
        try {
            return find_helper(pictures_program);
        } catch (const FileError&) {
            throw InputError(
                fmt::format("pictures of other kinds than PNG, JPEG and WebP are read by {}, which is not installed "
                            "here: install it, or "
                            "save the picture as PNG",
                            pictures_program));
        }
    }

    std::string what_;
    IsolationLimits limits_;
    double spent_s_ = 0;                                    ///< on pictures, of the processor
    std::shared_ptr<IsolatedProgram> pictures_, drawings_;  ///< wait for the next one; shared: functions are copied
};

}  // namespace

std::vector<std::byte> pack(const ReadRequest& r) {
    PackedWriter writer;
    writer(protocol, r.kind, r.path, r.max_file_bytes, r.max_pixels, r.max_unpacked_bytes, r.texture, r.samples,
           r.sees_folder, r.keep_alpha, r.format, r.use_profile, r.turn_upright, r.drawing.pitch_mm, r.drawing.width_mm,
           r.drawing.height_mm, r.drawing.size_mm, r.drawing.px_per_inch, r.bytes);
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
    reader(r.kind, r.path, r.max_file_bytes, r.max_pixels, r.max_unpacked_bytes, r.texture, r.samples, r.sees_folder,
           r.keep_alpha, r.format, r.use_profile, r.turn_upright, r.drawing.pitch_mm, r.drawing.width_mm,
           r.drawing.height_mm, r.drawing.size_mm, r.drawing.px_per_inch, r.bytes);
    reader.expect_end();
    return r;
}

std::unique_ptr<IsolatedProgram> start_reader(ReadKind kind, const std::filesystem::path& path,
                                              const ReadOptions& options, bool sees_folder) {
    ReadRequest request;
    request.kind = kind;
    request.path = path.string();
    request.max_file_bytes = options.max_file_bytes;
    request.max_pixels = options.max_pixels;
    request.max_unpacked_bytes = options.max_unpacked_bytes;
    request.drawing = options.drawing;
    request.texture = options.texture.string();
    request.sees_folder = sees_folder;
    request.keep_alpha = options.keep_alpha;
    return start_reader(path.filename().string(), request, isolation_limits(options));
}

std::unique_ptr<IsolatedProgram> start_reader(const std::string& what, const ReadRequest& request,
                                              IsolationLimits limits) {
    if (built_with_address_sanitizer()) limits.memory_bytes = 0;
    const PathInZip place = path_in_zip(request.path);
    if (!request.path.empty()) limits.readable.push_back(place.file.string());
    const bool is_model = request.kind == ReadKind::model || request.kind == ReadKind::side_files;
    if (is_model && request.sees_folder && !place.is_zip) {
        const std::filesystem::path folder = place.file.parent_path();
        for (std::string& file : files_beside(folder)) limits.readable.push_back(std::move(file));
        limits.listable.push_back(folder.empty() ? "." : folder.string());  // names are found in any case
    }
    if (!request.texture.empty()) limits.readable.push_back(request.texture);
    const bool by_openimageio = request.kind == ReadKind::photograph || request.kind == ReadKind::other_picture;
    auto program = std::make_unique<IsolatedProgram>(
        what, find_helper(by_openimageio ? pictures_program : "voxtone-read"), pack(request), limits);
    if (!by_openimageio) program->answer_by(ReaderAnswers(what, limits));
    return program;
}

namespace {

void warn_of_walls(const IsolatedProgram& reader, std::vector<std::string>& warnings) {
    if (std::string note = told_walls().note(reader.missing_walls()); !note.empty())
        warnings.push_back(named_warning("less-guarded", std::move(note)));
}

}  // namespace

std::vector<std::byte> read_guarded(IsolatedProgram& reader, const Progress* progress,
                                    std::vector<std::string>& warnings) {
    std::vector<std::byte> bytes = reader.result(progress);
    warn_of_walls(reader, warnings);
    return bytes;
}

void read_guarded(IsolatedProgram& reader, const Progress* progress, std::vector<std::string>& warnings,
                  const std::function<void(PackedReader&)>& unpack) {
    IsolatedProgram::Pieces pieces = reader.result_in_pieces(progress);
    warn_of_walls(reader, warnings);
    PackedReader answer(pieces.size, std::move(pieces.fetch));
    unpack(answer);
}

}  // namespace voxtone::io
