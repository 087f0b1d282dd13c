// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/codes_in_picture.h"

#include <cstddef>

#include "base/contracts.h"
#include "io/files/file_reader.h"

namespace voxtone::io {

std::vector<CodeInPicture> codes_in_picture(const LuminanceRaster& picture, int most_times, const Progress* progress) {
    VOXTONE_EXPECT(picture.columns >= 0 && picture.rows >= 0);
    VOXTONE_EXPECT(picture.grey.size() == std::size_t(picture.columns) * std::size_t(picture.rows));
    if (picture.grey.empty()) return {};
    ReadRequest request;
    request.kind = ReadKind::codes;
    request.samples = {double(picture.columns), double(picture.rows), double(most_times)};
    for (const std::uint8_t grey : picture.grey) request.bytes.push_back(std::byte{grey});
    const auto reader = start_reader("the codes of the picture", request, {});
    std::vector<std::string> of_walls;  // said where the picture itself was read
    std::vector<CodeInPicture> codes;
    read_guarded(*reader, progress, of_walls, [&](PackedReader& answer) {
        answer(codes);
        answer.expect_end();
    });
    return codes;
}

}  // namespace voxtone::io
