// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/io/codecs/no_threads.h"

#include <OpenImageIO/imageio.h>

namespace voxtone::io {

void use_no_threads() {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
}

}  // namespace voxtone::io
