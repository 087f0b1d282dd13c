// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/zip_writer.h"

#include <memory>

#include <fmt/core.h>
#include <zip.h>

#include "base/error.h"
#include "io/disk/disk_space.h"
#include "io/files/whole_file.h"

namespace voxtone::io {
namespace {

struct Discard {
    void operator()(zip_t* zip) const { zip_discard(zip); }
};
using Archive = std::unique_ptr<zip_t, Discard>;

[[noreturn]] void fail_to_pack(const std::filesystem::path& file, zip_t* zip) {
    if (zip_error_t* const error = zip_get_error(zip); zip_error_system_type(error) == ZIP_ET_SYS)
        fail_to_write(file, "could not be written", zip_error_code_system(error));
    throw FileError(fmt::format("{}: could not be written ({})", file.string(), zip_strerror(zip)));
}

/// False where libzip says why.
bool add(zip_t* zip, const ZipEntry& entry) {
    constexpr zip_uint16_t first_date = 0x21;  // 1980-01-01
    zip_source_t* const source = entry.file.empty() ? zip_source_buffer(zip, entry.bytes.data(), entry.bytes.size(), 0)
                                                    : zip_source_file(zip, entry.file.c_str(), 0, -1);
    if (!source) return false;
    const zip_int64_t index = zip_file_add(zip, entry.name.c_str(), source, ZIP_FL_ENC_GUESS);
    if (index < 0) {
        zip_source_free(source);
        return false;
    }
    const auto at = static_cast<zip_uint64_t>(index);
    return zip_set_file_compression(zip, at, entry.deflate ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0) == 0 &&
           zip_file_set_dostime(zip, at, 0, first_date, 0) == 0;
}

}  // namespace

void write_zip(const std::filesystem::path& file, std::span<const ZipEntry> entries, const Progress* progress) {
    int code = 0;
    Archive zip(zip_open(part_path(file).c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code));
    if (!zip) throw FileError(fmt::format("{}: cannot be created; is the folder there and writable?", file.string()));
    for (const ZipEntry& entry : entries)
        if (!add(zip.get(), entry)) fail_to_pack(file, zip.get());
    if (progress)
        zip_register_cancel_callback_with_state(
            zip.get(), [](zip_t*, void* p) { return static_cast<const Progress*>(p)->cancelled() ? 1 : 0; }, nullptr,
            const_cast<Progress*>(progress));
    if (zip_close(zip.get()) != 0) {
        if (progress) progress->check_cancelled();
        fail_to_pack(file, zip.get());
    }
    (void)zip.release();  // closed
    finish_part(file);
}

}  // namespace voxtone::io
