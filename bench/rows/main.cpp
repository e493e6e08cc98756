// Two builds of the library, row by row: instructions that a call takes, or time.
//
//   rows_compare count OLD.so NEW.so WHICH      under callgrind; dumps a file per row, prints name, kind, bonds; of
//   NEW,
//                                               OLD moves the atoms alone
//   rows_compare time OLD.so NEW.so WHICH       prints name, kind, bonds, ns per bond of both: medians of calls in
//   turns
//
// WHICH: lanes, alone, or any part of a row's name. See scripts/rows.
#include <time.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>

#include "row.hpp"

namespace {

using namespace rows;

/// A row with one library: so many sets of arrays that the calls on all of them last long enough to be timed.
class Run {
public:
    Run(const Row &row, const Library &library, const Scene &scene)
        : row_(row), library_(library), scene_(scene), handle_(make_handle(library, scene)),
          factors_(nullptr, library.hol_factors_destroy), fresh_(row.layout, scene, row.moved) {
        if (row.keeps) {
            hol_factors *made = nullptr;
            library.check(library.hol_factors_create(handle_.get(), &made));
            factors_.reset(made);
            library.check(library.hol_factors_update(made, fresh_.r.packed()));
        }
        copies_ = std::max<std::size_t>(1, 4000 / scene.bonds());
        for (std::size_t i = 0; i < copies_; ++i) arrays_.emplace_back(row.layout, scene, row.moved);
    }

    /// What the last calls have written is forgotten.
    void prepare() {
        for (Arrays &a : arrays_) {
            a.r.copy(fresh_.r);
            a.v.copy(fresh_.v);
        }
    }

    void calls() {
        int status = HOL_OK;
        for (Arrays &a : arrays_) status |= row_.call({library_, scene_, handle_.get(), factors_.get(), a});
        library_.check(status);
    }

    double bonds() const { return static_cast<double>(copies_ * scene_.bonds()); }

private:
    const Row &row_;
    const Library &library_;
    const Scene &scene_;
    Handle handle_;
    std::unique_ptr<hol_factors, void (*)(hol_factors *)> factors_;
    std::size_t copies_ = 1;
    Arrays fresh_;
    std::vector<Arrays> arrays_;
};

const char *kind(const Row &row) { return row.common ? "common" : "other"; }

void count(const Row &row, const Library &library, const Scene &scene) {
    Run run(row, library, scene);
    run.prepare();
    run.calls();  // this thread's memory is there from now on
    run.prepare();
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    run.calls();
    CALLGRIND_DUMP_STATS;
    CALLGRIND_STOP_INSTRUMENTATION;
    std::printf("%s|%s|%.0f\n", row.name.c_str(), kind(row), run.bonds());
    std::fflush(stdout);
}

double now() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void measure(const Row &row, const Library (&libraries)[2], const Scene &scene) {
    Run runs[2] = {{row, libraries[0], scene}, {row, libraries[1], scene}};
    std::vector<double> times[2];
    const int turns = 101;
    for (int turn = -3; turn < turns; ++turn)
        for (int i = 0; i < 2; ++i) {
            const int which = (i + turn) & 1;  // each comes first as often as the other
            runs[which].prepare();
            const double begin = now();
            runs[which].calls();
            const double end = now();
            if (turn >= 0) times[which].push_back((end - begin) / runs[which].bonds());
        }
    std::printf("%s|%s|%.0f|%.4f|%.4f\n", row.name.c_str(), kind(row), runs[0].bonds(), median(times[0]),
                median(times[1]));
    std::fflush(stdout);
}

bool wanted(const Row &row, const std::string &which) {
    if (which == "alone") return row.alone;
    if (which == "lanes") return !row.alone;
    return row.name.find(which) != std::string::npos;
}

int run(char **argv) {
    const bool counting = std::strcmp(argv[1], "count") == 0;
    const Library libraries[2] = {Library(argv[2]), Library(argv[3])};
    for (const Row &row : all_rows()) {
        if (!wanted(row, argv[4])) continue;
        if (row.keeps && (!libraries[0].hol_factors_create || !libraries[1].hol_factors_create)) continue;
        const Scene scene = make_scene(row.recipe(), libraries[0]);
        if (counting)
            count(row, libraries[1], scene);
        else
            measure(row, libraries, scene);
    }
    std::fprintf(stderr, "kernels: %s; of the old library %s\n", libraries[1].hol_instruction_set(),
                 libraries[0].hol_instruction_set());
    return 0;
}

}  // namespace

int main(int argc, char **argv) {
    if (argc != 5) {
        std::fputs("usage: rows_compare count|time OLD.so NEW.so WHICH\n", stderr);
        return 2;
    }
    try {
        return run(argv);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "rows_compare: %s\n", error.what());
        return 1;
    }
}
