// The kernels of a plan, compiled as CUDA would be and run here, beside the library's own functions.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

#include "cuda.hpp"
#include "scene.h"
#ifdef IN_BOX  // in which each atom is moved to where it may be, whatever its neighbours do
static const double edge = 12;
#define HOL_IMAGE(d)                                                                    \
    make_mixed3(d.x - edge * std::rint(d.x / edge), d.y - edge * std::rint(d.y / edge), \
                d.z - edge * std::rint(d.z / edge))
#endif
#include TEXT

namespace
{

constexpr hol_device_precision precision = sizeof(mixed) == sizeof(float)  ? HOL_DEVICE_SINGLE
                                           : sizeof(real) == sizeof(float) ? HOL_DEVICE_MIXED
                                                                           : HOL_DEVICE_DOUBLE;
// Coordinates are below 64, of which roundings come into bonds of about 1.
constexpr double rounding = sizeof(mixed) == sizeof(float) ? 64 * 6e-8 : 64 * 1.1e-16;
constexpr double dt = 0.05;
constexpr std::size_t n = 3 * SCENE_ATOMS;
int failures_found = 0;

void expect(bool right, const char *what)
{
    if (right) return;
    std::printf("not so: %s (%s)\n", what, hol_error_message());
    ++failures_found;
}
#define EXPECT(what) expect(what, #what)

using Numbers = std::vector<double>;
using Array = std::vector<mixed>;
using Ints = std::vector<std::int32_t>;

struct PlanArrays {
    Ints integers, failed;
    Array numbers, scratch;

    explicit PlanArrays(const hol_device_plan *plan)
    {
        fill(plan, HOL_DEVICE_INTEGERS, integers);
        fill(plan, HOL_DEVICE_NUMBERS, numbers);
        fill(plan, HOL_DEVICE_SCRATCH, scratch);
        fill(plan, HOL_DEVICE_FAILURES, failed);
    }
    template <class Element>
    static void fill(const hol_device_plan *plan, hol_device_array which, std::vector<Element> &array)
    {
        const void *data;
        std::int64_t bytes;
        EXPECT(hol_device_plan_array(plan, which, &data, &bytes) == HOL_OK);
        array.resize(static_cast<std::size_t>(bytes) / sizeof(Element));
        if (data) std::memcpy(array.data(), data, static_cast<std::size_t>(bytes));
    }
};

// All launches of the plan, on arrays of the precision.
class Kernels
{
public:
    explicit Kernels(const scene &s) : plan_(scene_plan(&s, precision)), arrays(plan_)
    {
    }
    ~Kernels()
    {
        hol_device_plan_destroy(plan_);
    }
    Kernels(const Kernels &) = delete;
    Kernels &operator=(const Kernels &) = delete;

    void positions(const Array &r_ref, Array &r, Array *v, int call)
    {
        for_launches([&](std::size_t k) {
            kernels[k].positions(arrays.integers.data(), arrays.numbers.data(), arrays.scratch.data(),
                                 arrays.failed.data(), call, r_ref.data(), r.data(), v ? v->data() : nullptr,
                                 v ? static_cast<mixed>(1 / dt) : 0);
        });
    }
    void velocities(const Array &r, Array &v, int call)
    {
        for_launches([&](std::size_t k) {
            kernels[k].velocities(arrays.integers.data(), arrays.numbers.data(), arrays.scratch.data(),
                                  arrays.failed.data(), call, r.data(), v.data());
        });
    }

private:
    template <class Launch>
    void for_launches(const Launch &launch) const
    {
        constexpr std::size_t n_launches = sizeof kernels / sizeof *kernels;
        EXPECT(hol_device_plan_n_launches(plan_) == n_launches);
        for (std::size_t k = 0; k < n_launches; ++k) {
            std::int64_t n_groups, size;
            EXPECT(hol_device_plan_launch(plan_, static_cast<std::int64_t>(k), nullptr, nullptr, &n_groups, &size) ==
                   HOL_OK);
            for_blocks(blocks ? blocks : static_cast<unsigned>(size * n_groups), [&] { launch(k); });
        }
    }

    hol_device_plan *plan_;

public:
    PlanArrays arrays;
    unsigned blocks = 0;  // 0: as many as the plan has work-items
};

std::size_t at(std::int64_t atom)
{
    return static_cast<std::size_t>(3 * atom);
}

// Of what is on the device.
double apart(const Array &found, const Numbers &right)
{
    double most = 0;
    for (std::size_t e = 0; e < 3 * SCENE_ON_DEVICE; ++e)
        if (!(std::fabs(found[e] - right[e]) <= most)) most = std::fabs(found[e] - right[e]);
    return most;
}

void wrap(Array &r)
{
#ifdef IN_BOX
    for (mixed &x : r) x -= edge * std::floor(x / edge);
#else
    (void)r;
#endif
}

// From the rounded arrays themselves, so that all differences are the kernels'.
void a_step_is_as_on_the_host(const scene &s, unsigned blocks)
{
    Kernels device(s);
    device.blocks = blocks;
    Array r_ref(s.r, s.r + n), v(s.v, s.v + n);
    wrap(r_ref);
    device.velocities(r_ref, v, 1);
    Array r = r_ref;
    for (std::size_t e = 0; e < n; ++e) r[e] += static_cast<mixed>(dt) * v[e];
    Numbers host_ref(r_ref.begin(), r_ref.end()), host_v(s.v, s.v + n), host_r(r.begin(), r.end());
    EXPECT(hol_project_velocities(s.chains, host_ref.data(), host_v.data(), nullptr, nullptr) == HOL_OK);
    std::printf("velocities %.1e", apart(v, host_v) / rounding);
    EXPECT(apart(v, host_v) <= 10 * rounding);
    host_v.assign(v.begin(), v.end());
    EXPECT(hol_project_positions(s.chains, host_ref.data(), host_r.data(), host_v.data(), dt, nullptr, 0, nullptr,
                                 nullptr) == HOL_OK);
    const Array moved = r, v_moved = v;
    device.positions(r_ref, r, &v, 2);
    EXPECT(apart(moved, host_r) > 1e-3);
    std::printf(", positions %.1e, velocities %.1e roundings apart\n", apart(r, host_r) / rounding,
                apart(v, host_v) / rounding * dt);
    EXPECT(apart(r, host_r) <= 10 * rounding);
    EXPECT(apart(v, host_v) <= 10 * rounding / dt);
    EXPECT(device.arrays.failed == Ints(device.arrays.failed.size(), 0));
    for (std::size_t e = 3 * SCENE_ON_DEVICE; e < n; ++e) EXPECT(r[e] == moved[e] && v[e] == v_moved[e]);
    Array alone = moved;  // without velocities the same
    device.positions(r_ref, alone, nullptr, 3);
    EXPECT(alone == r);
}

void a_molecule_that_cannot_be_solved_is_told_and_stays(const scene &s)
{
    Kernels device(s);
    const Array r_ref(s.r, s.r + n);
    const std::int64_t water = 64, large = 73;  // the second batch; the comb in scratch
    for (const std::int64_t molecule : {water, large}) {
        std::int64_t atoms[SCENE_ATOMS], count;
        EXPECT(hol_chains_atoms(s.chains, molecule, atoms) == HOL_OK);
        EXPECT(hol_chains_molecule(s.chains, molecule, nullptr, &count, nullptr) == HOL_OK);
        EXPECT(count == (molecule == water ? 3 : 701));
        Array r = r_ref;
        r[at(atoms[1])] += 40;
        const Array before = r;
        const int call = molecule == water ? 7 : 9;
        device.positions(r_ref, r, nullptr, call);
        for (std::int64_t i = 0; i < count; ++i)
            for (std::size_t e = 0; e < 3; ++e) EXPECT(r[at(atoms[i]) + e] == before[at(atoms[i]) + e]);
        EXPECT(device.arrays.failed[0] == 1);
        EXPECT(device.arrays.failed[static_cast<std::size_t>(1 + molecule)] == call);
        device.positions(r_ref, r, nullptr, 11);  // the first time is kept
        EXPECT(device.arrays.failed[static_cast<std::size_t>(1 + molecule)] == call);
    }
    std::size_t n_failed = 0;
    for (std::size_t k = 1; k < device.arrays.failed.size(); ++k) n_failed += device.arrays.failed[k] != 0;
    EXPECT(n_failed == 2);
}

}  // namespace

int main()
{
    static scene s;
    scene_make(&s);
#ifdef IN_BOX
    const double box[9] = {edge, 0, 0, 0, edge, 0, 0, 0, edge};
    EXPECT(hol_chains_set_box(s.chains, box) == HOL_OK);
#endif
    a_step_is_as_on_the_host(s, 0);
    a_step_is_as_on_the_host(s, 3);
    a_molecule_that_cannot_be_solved_is_told_and_stays(s);
    hol_chains_destroy(s.chains);
    return failures_found != 0;
}
