// Threads of one call.
#pragma once

namespace holonomic {

// Calls body(context, i) for i = 0 .. n-1, each on a thread of its own, 0 on the calling one. A body takes work until
// there is none left, whosever it was: body 0 alone does all of it, and that is what happens where threads keep the
// caller waiting, because other programs use their processors, and without OpenMP.
void on_threads(int n, void (*body)(const void *context, int i), const void *context);

template <class Body>
void on_threads(int n, const Body &body) {
    on_threads(
        n, [](const void *context, int i) { (*static_cast<const Body *>(context))(i); }, &body);
}

}  // namespace holonomic
