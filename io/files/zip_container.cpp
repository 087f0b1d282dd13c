// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/files/zip_container.h"

#include <algorithm>
#include <mutex>

#include <fmt/core.h>
#include <zip.h>

#include "voxtone/base/error.h"

namespace voxtone::io {

struct ZipContainer::Handle {
    zip_t* zip = nullptr;
    std::mutex mutex;
    Handle() = default;
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (zip) zip_discard(zip);
    }
};

ZipContainer::ZipContainer(const std::filesystem::path& file)
    : path_(file.string()), handle_(std::make_unique<Handle>()) {
    int code = 0;
    handle_->zip = zip_open(path_.c_str(), ZIP_RDONLY, &code);
    if (!handle_->zip) {
        zip_error_t error;
        zip_error_init_with_code(&error, code);
        const std::string why = zip_error_strerror(&error);
        zip_error_fini(&error);
        if (code == ZIP_ER_OPEN || code == ZIP_ER_NOENT || code == ZIP_ER_READ)
            throw FileError(fmt::format("{}: cannot be opened for reading ({})", path_, why));
        throw InputError(fmt::format("{}: is no ZIP container that can be read ({}); it may be cut short", path_, why));
    }
    const auto entries = zip_get_num_entries(handle_->zip, 0);
    for (zip_int64_t i = 0; i < entries; ++i) {
        const char* const name = zip_get_name(handle_->zip, static_cast<zip_uint64_t>(i), 0);
        names_.emplace_back(name ? name : "");
    }
}

ZipContainer::~ZipContainer() = default;

std::vector<std::uint8_t> ZipContainer::read(std::size_t index, std::uint64_t most) const {
    const std::lock_guard lock(handle_->mutex);
    const std::string name = fmt::format("{}: entry {}", path_, names_.at(index));
    zip_stat_t stat;
    if (zip_stat_index(handle_->zip, index, 0, &stat) != 0 || !(stat.valid & ZIP_STAT_SIZE))
        throw InputError(fmt::format("{}: its size is not known; make the container again", name));
    if (stat.size > most)
        throw InputError(fmt::format("{}: claims {} bytes, more than the {} that it may have", name, stat.size, most));
    zip_file_t* const entry = zip_fopen_index(handle_->zip, index, 0);
    if (!entry) throw InputError(fmt::format("{}: cannot be read ({})", name, zip_strerror(handle_->zip)));
    // Grows as bytes come: an entry that only claims its size costs no memory.
    std::vector<std::uint8_t> bytes;
    constexpr std::size_t piece = std::size_t{1} << 18;
    zip_int64_t got = 0;
    do {
        const std::size_t have = bytes.size();
        bytes.resize(have + piece);
        got = zip_fread(entry, bytes.data() + have, piece);
        bytes.resize(have + static_cast<std::size_t>(std::max<zip_int64_t>(got, 0)));
    } while (got > 0 && bytes.size() <= most);
    const std::string why = got < 0 ? zip_file_strerror(entry) : "";
    zip_fclose(entry);
    if (got < 0) throw InputError(fmt::format("{}: is damaged ({})", name, why));
    if (bytes.size() != stat.size)
        throw InputError(fmt::format("{}: holds {} bytes and claims {}", name, bytes.size(), stat.size));
    return bytes;
}

}  // namespace voxtone::io
