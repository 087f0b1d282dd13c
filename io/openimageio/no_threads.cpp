// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/openimageio/no_threads.h"

#include <dlfcn.h>

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/thread.h>

namespace voxtone::io {

void use_no_threads() {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    // LibRaw develops with OpenMP, whose runtime ends the program where it may start no thread.
    if (void* const set_threads = dlsym(RTLD_DEFAULT, "omp_set_num_threads"))
        reinterpret_cast<void (*)(int)>(set_threads)(1);
}

void end_threads() {
    use_no_threads();
    OIIO::default_thread_pool()->resize(0);
    // log4cplus::deinitialize(); it comes with Debian's OpenImageIO, and we have no other business with it.
    if (void* const deinitialize = dlsym(RTLD_DEFAULT, "_ZN9log4cplus12deinitializeEv"))
        reinterpret_cast<void (*)()>(deinitialize)();
}

}  // namespace voxtone::io
