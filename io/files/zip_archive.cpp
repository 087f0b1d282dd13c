// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/zip_archive.h"

#include <algorithm>

#include <fmt/format.h>
#include <zip.h>

#include "voxtone/base/error.h"

namespace voxtone::io {

namespace {

constexpr std::uint64_t small = std::uint64_t{64} << 20, largest_ratio = 200;

struct CloseFile {
    void operator()(zip_file_t* file) const { zip_fclose(file); }
};

}  // namespace

struct ZipArchive::Handle {
    zip_t* zip = nullptr;
};

ZipArchive::ZipArchive(std::span<const std::byte> bytes, std::string name, std::uint64_t max_unpacked_bytes)
    : name_(std::move(name)), handle_(std::make_unique<Handle>()) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
    if (source) handle_->zip = zip_open_from_source(source, ZIP_RDONLY, &error);
    if (!handle_->zip) {
        const std::string why = zip_error_strerror(&error);
        if (source) zip_source_free(source);
        zip_error_fini(&error);
        throw InputError(fmt::format("{} cannot be opened as an archive ({}); it is damaged or cut short", name_, why));
    }
    zip_error_fini(&error);
    std::uint64_t total = 0;
    const zip_int64_t count = zip_get_num_entries(handle_->zip, 0);
    for (zip_int64_t i = 0; i < count; ++i) {
        zip_stat_t about;
        if (zip_stat_index(handle_->zip, static_cast<zip_uint64_t>(i), 0, &about) != 0 ||
            !(about.valid & ZIP_STAT_SIZE))
            continue;
        if (about.size > max_unpacked_bytes || (total += about.size) > max_unpacked_bytes ||
            (about.size > small && (about.valid & ZIP_STAT_COMP_SIZE) &&
             about.size / largest_ratio > about.comp_size)) {
            zip_discard(handle_->zip);
            throw InputError(fmt::format(
                "{} declares parts that unpack to more than {} bytes, or {} times their size: it is no model but made "
                "to fill the memory",
                name_, max_unpacked_bytes, largest_ratio));
        }
    }
}

ZipArchive::~ZipArchive() { zip_discard(handle_->zip); }

std::optional<std::vector<std::byte>> ZipArchive::read(const std::string& part) const {
    const std::string path = part.starts_with('/') ? part.substr(1) : part;
    zip_int64_t index = zip_name_locate(handle_->zip, path.c_str(), 0);
    if (index < 0) index = zip_name_locate(handle_->zip, path.c_str(), ZIP_FL_NOCASE);
    if (index < 0) return std::nullopt;
    zip_stat_t about;
    if (zip_stat_index(handle_->zip, static_cast<zip_uint64_t>(index), 0, &about) != 0 ||
        !(about.valid & ZIP_STAT_SIZE))
        throw InputError(fmt::format("the part '{}' of {} has no size; the file is damaged", path, name_));
    const std::unique_ptr<zip_file_t, CloseFile> file(
        zip_fopen_index(handle_->zip, static_cast<zip_uint64_t>(index), 0));
    const auto damaged = [&] {
        return InputError(fmt::format(
            "the part '{}' of {} cannot be unpacked; the file is damaged, cut short or locked", path, name_));
    };
    if (!file) throw damaged();
    // What arrives decides, not what was declared; nothing beyond the declared size is taken.
    std::vector<std::byte> bytes;
    constexpr std::size_t step = std::size_t{1} << 20;
    for (;;) {
        const std::size_t have = bytes.size();
        bytes.resize(have + std::min<std::uint64_t>(std::max(step, have), about.size - have + 1));
        const zip_int64_t got = zip_fread(file.get(), bytes.data() + have, bytes.size() - have);
        if (got < 0) throw damaged();
        bytes.resize(have + static_cast<std::size_t>(got));
        if (got == 0) break;
        if (bytes.size() > about.size) throw damaged();
    }
    if (bytes.size() != about.size) throw damaged();
    return bytes;
}

}  // namespace voxtone::io
