// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files/zip_reader.h"

#include <algorithm>
#include <mutex>
#include <system_error>

#include <fmt/core.h>
#include <zip.h>

#include "base/error.h"

namespace voxtone::io {

namespace {

constexpr std::uint64_t any_ratio_bytes = std::uint64_t{64} << 20, largest_ratio = 200;

struct CloseZipPart {
    void operator()(zip_file_t* part) const { zip_fclose(part); }
};

struct ZipError {
    zip_error_t error;
    ZipError() { zip_error_init(&error); }
    explicit ZipError(int code) { zip_error_init_with_code(&error, code); }
    ZipError(const ZipError&) = delete;
    ZipError& operator=(const ZipError&) = delete;
    ~ZipError() { zip_error_fini(&error); }
};

[[noreturn]] void refuse_archive(const std::string& name, ZipError& why) {
    throw InputError(fmt::format("{}: is no ZIP archive that can be opened ({}); it is damaged or cut short", name,
                                 zip_error_strerror(&why.error)));
}

}  // namespace

PathInZip path_in_zip(const std::filesystem::path& path) {
    const auto ends_as_zip = [](const std::filesystem::path& part) {
        std::string extension = part.extension().string();
        for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
        return extension == ".zip";
    };
    for (std::filesystem::path part = path.parent_path(); part.has_relative_path(); part = part.parent_path())
        if (std::error_code none; ends_as_zip(part) && std::filesystem::is_regular_file(part, none))
            return {part, path.lexically_relative(part).generic_string(), true};
    return {path, {}, ends_as_zip(path)};
}

struct ZipReader::Handle {
    zip_t* zip = nullptr;
    std::mutex mutex;
    Handle() = default;
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (zip) zip_discard(zip);
    }
};

ZipReader::ZipReader(const std::filesystem::path& file, const ZipLimits& limits)
    : name_(file.string()), limits_(limits), handle_(std::make_unique<Handle>()) {
    // What is empty libzip takes for a file that is not there.
    if (std::error_code none; std::filesystem::is_regular_file(file, none) && std::filesystem::is_empty(file, none))
        throw InputError(fmt::format("{}: is empty", name_));
    int code = 0;
    handle_->zip = zip_open(name_.c_str(), ZIP_RDONLY, &code);
    if (!handle_->zip) {
        ZipError why(code);
        if (code == ZIP_ER_OPEN || code == ZIP_ER_NOENT || code == ZIP_ER_READ)
            throw FileError(
                fmt::format("{}: cannot be opened for reading ({})", name_, zip_error_strerror(&why.error)));
        refuse_archive(name_, why);
    }
    list_parts();
}

ZipReader::ZipReader(std::span<const std::byte> bytes, std::string name, const ZipLimits& limits)
    : name_(std::move(name)), limits_(limits), handle_(std::make_unique<Handle>()) {
    ZipError why;
    zip_source_t* const source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &why.error);
    if (source) handle_->zip = zip_open_from_source(source, ZIP_RDONLY, &why.error);
    if (!handle_->zip) {
        if (source) zip_source_free(source);
        refuse_archive(name_, why);
    }
    list_parts();
}

ZipReader::~ZipReader() = default;

void ZipReader::list_parts() {
    std::uint64_t total = 0;
    const auto count = static_cast<zip_uint64_t>(std::max<zip_int64_t>(zip_get_num_entries(handle_->zip, 0), 0));
    for (zip_uint64_t i = 0; i < count; ++i) {
        const char* const part = zip_get_name(handle_->zip, i, 0);
        names_.emplace_back(part ? part : "");
        zip_stat_t about;
        if (zip_stat_index(handle_->zip, i, 0, &about) != 0 || !(about.valid & ZIP_STAT_SIZE)) continue;
        if (about.size > limits_.total_bytes - total)
            throw InputError(
                fmt::format("{}: declares parts that unpack to more than {} bytes: it is made to fill the memory",
                            name_, limits_.total_bytes));
        total += about.size;
    }
}

std::optional<std::size_t> ZipReader::find(const std::string& part) const {
    const std::string path = part.starts_with('/') ? part.substr(1) : part;
    const std::lock_guard lock(handle_->mutex);
    zip_int64_t index = zip_name_locate(handle_->zip, path.c_str(), 0);
    if (index < 0) index = zip_name_locate(handle_->zip, path.c_str(), ZIP_FL_NOCASE);
    if (index < 0) return std::nullopt;
    return static_cast<std::size_t>(index);
}

std::uint64_t ZipReader::size(std::size_t index) const {
    const std::lock_guard lock(handle_->mutex);
    zip_stat_t about;
    const bool known = zip_stat_index(handle_->zip, index, 0, &about) == 0 && (about.valid & ZIP_STAT_SIZE);
    return known ? about.size : 0;
}

std::uint64_t ZipReader::checked_size(std::size_t index, std::uint64_t most, const std::string& part) const {
    zip_stat_t about;
    if (zip_stat_index(handle_->zip, index, 0, &about) != 0 || !(about.valid & ZIP_STAT_SIZE))
        throw InputError(fmt::format("{}: its size is not known; the file is damaged, make it again", part));
    if (about.size > most)
        throw InputError(fmt::format("{}: claims {} bytes, more than the {} that it may have", part, about.size, most));
    if (about.size > any_ratio_bytes && (about.valid & ZIP_STAT_COMP_SIZE) &&
        about.size / largest_ratio > about.comp_size)
        throw InputError(fmt::format(
            "{}: claims to unpack to more than {} times its size: it is made to fill the memory", part, largest_ratio));
    return about.size;
}

template <class Byte>
std::vector<Byte> ZipReader::unpack(std::size_t index, std::uint64_t most) const {
    const std::lock_guard lock(handle_->mutex);
    const std::string part = fmt::format("{}: part '{}'", name_, names_.at(index));
    const std::uint64_t size = checked_size(index, std::min(most, limits_.part_bytes), part);
    const std::unique_ptr<zip_file_t, CloseZipPart> file(zip_fopen_index(handle_->zip, index, 0));
    if (!file) {
        const int why = zip_error_code_zip(zip_get_error(handle_->zip));
        throw InputError(fmt::format("{}: cannot be unpacked ({}){}", part, zip_strerror(handle_->zip),
                                     why == ZIP_ER_NOPASSWD      ? "; unpack the archive and give what is in it"
                                     : why == ZIP_ER_COMPNOTSUPP ? "; pack it again as an ordinary ZIP (deflate)"
                                                                 : ""));
    }
    // What arrives decides: a part that only claims its size costs no memory, and nothing beyond the size is taken.
    std::vector<Byte> bytes;
    constexpr std::size_t step = std::size_t{1} << 20;
    zip_int64_t got = 0;
    do {
        const std::size_t have = bytes.size();
        bytes.resize(have + std::min<std::uint64_t>(std::max(step, have), size - have + 1));
        got = zip_fread(file.get(), bytes.data() + have, bytes.size() - have);
        bytes.resize(have + static_cast<std::size_t>(std::max<zip_int64_t>(got, 0)));
    } while (got > 0 && bytes.size() <= size);
    if (got < 0)
        throw InputError(fmt::format("{}: is damaged, cut short or locked ({})", part, zip_file_strerror(file.get())));
    if (bytes.size() != size)
        throw InputError(fmt::format("{}: holds {} bytes and claims {}", part, bytes.size(), size));
    return bytes;
}

std::vector<std::uint8_t> ZipReader::read(std::size_t index, std::uint64_t most) const {
    return unpack<std::uint8_t>(index, most);
}

std::vector<std::byte> ZipReader::read(std::size_t index) const { return unpack<std::byte>(index, limits_.part_bytes); }

std::optional<std::vector<std::byte>> ZipReader::read(const std::string& part) const {
    const auto index = find(part);
    if (!index) return std::nullopt;
    return read(*index);
}

}  // namespace voxtone::io
