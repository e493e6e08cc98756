#include <string>

#include "core/device/group_table.hpp"
#include "core/device/source.hpp"

namespace holonomic::device {

namespace {

// A molecule's numbers stand where all work-items of its group see them: displacements or velocities u of the atoms,
// bonds s; of the matrix the rows' vectors d, the right-hand side and then the solution g, the pivots' inverses, and
// the entries above and below the diagonal, which are the same array where it is symmetric. Each number is written by
// one work-item, sums have one order, and a level waits for the one before: nothing depends on which comes first.
const char solution[] = R"(
#define MOLECULE GLOBAL const int* RESTRICT table, GLOBAL const mixed* RESTRICT w, SCRATCH_ARG mixed* u, \
    SCRATCH_ARG mixed* s, SCRATCH_ARG real* d, SCRATCH_ARG real* g, SCRATCH_ARG real* inverse, \
    SCRATCH_ARG real* upper, SCRATCH_ARG real* lower
#define THE_MOLECULE table, w, u, s, d, g, inverse, upper, lower
#define N_ATOMS SIZES[0]
#define N_BONDS SIZES[1]
#define N_LEVELS SIZES[2]
#define EACH(i, first, last) (int i = (first) + LOCAL_ID; i < (last); i += LOCAL_SIZE)

DEVICE real along_bond@(int row, int column, MOLECULE) {
    return d[3*row]*(real) s[3*column] + d[3*row+1]*(real) s[3*column+1] + d[3*row+2]*(real) s[3*column+2];
}

DEVICE mixed3 difference@(int k, MOLECULE) {
    const int i = 3*ENDS[2*k], j = 3*ENDS[2*k+1];
    return make_mixed3(u[i]-u[j], u[i+1]-u[j+1], u[i+2]-u[j+2]);
}

// The pivot of a bond, and its right-hand side.
DEVICE void reduce_pivot@(int k, int factorize, MOLECULE) {
    real right = g[k];
    real pivot = factorize ? (real) (w[ENDS[2*k]] + w[ENDS[2*k+1]])*along_bond@(k, k, THE_MOLECULE) : 0;
    for (int t = EARLIER[k]; t < EARLIER[k+1]; ++t) {
        const int p = EARLIER_ENTRIES[2*t], m = EARLIER_ENTRIES[2*t+1];
        const real l = lower[p]*inverse[m];
        pivot -= l*upper[p];
        right -= l*g[m];
    }
    g[k] = right;
    if (factorize)
        inverse[k] = 1/pivot;
}

DEVICE void reduce_entry@(int p, MOLECULE) {
    const int k = ENTRIES[2*p], l = ENTRIES[2*p+1], shared = SHARED[p];
    const real weight = shared > 0 ? (real) w[shared-1] : shared < 0 ? -(real) w[-shared-1] : 0;
    real up = 0, down = 0;
    if (shared != 0) {
        up = weight*along_bond@(k, l, THE_MOLECULE);
        down = weight*along_bond@(l, k, THE_MOLECULE);
    }
    for (int t = TERMS[p]; t < TERMS[p+1]; ++t) {
        const int q = TERM_ENTRIES[3*t], r = TERM_ENTRIES[3*t+1];
        const real i = inverse[TERM_ENTRIES[3*t+2]];
        up -= lower[q]*i*upper[r];
        down -= lower[r]*i*upper[q];
    }
    upper[p] = up;
    if (lower != upper)
        lower[p] = down;
}

// The multipliers g for the right-hand side g, and what they do to u.
DEVICE void move_by@(int factorize, MOLECULE) {
    for (int level = 0; level < N_LEVELS; ++level) {
        const int first = LEVELS[level], last = LEVELS[level+1];
        for EACH(k, first, last)
            reduce_pivot@(k, factorize, THE_MOLECULE);
        if (factorize)
            for EACH(p, ROWS[first], ROWS[last])
                reduce_entry@(p, THE_MOLECULE);
        SYNC_THREADS;
    }
    for (int level = N_LEVELS-1; level >= 0; --level) {
        for EACH(k, LEVELS[level], LEVELS[level+1]) {
            real right = g[k];
            for (int p = ROWS[k]; p < ROWS[k+1]; ++p)
                right -= upper[p]*g[ENTRIES[2*p+1]];
            g[k] = inverse[k]*right;
        }
        SYNC_THREADS;
    }
    for EACH(i, 0, N_ATOMS) {
        mixed3 sum = make_mixed3(0, 0, 0);
        for (int t = ATOMS[i]; t < ATOMS[i+1]; ++t) {
            const int bond = BONDS_OF_ATOMS[t], k = bond > 0 ? bond-1 : -bond-1;
            const mixed by = bond > 0 ? (mixed) g[k] : -(mixed) g[k];
            sum += by*make_mixed3(s[3*k], s[3*k+1], s[3*k+2]);
        }
        u[3*i] += w[i]*sum.x;
        u[3*i+1] += w[i]*sum.y;
        u[3*i+2] += w[i]*sum.z;
    }
    SYNC_THREADS;
}

// What is no number stays, so that it is found.
#define KEEP_LARGER(value, most) if ((value) > most || (value) != (value)) most = value

DEVICE mixed largest@(mixed most, LOCAL_ARG mixed* found) {
    found[LOCAL_ID] = most;
    SYNC_THREADS;
    if (LOCAL_ID == 0)
        for (int k = 1; k < LOCAL_SIZE; ++k)
            KEEP_LARGER(found[k], found[0]);
    SYNC_THREADS;
    most = found[0];
    SYNC_THREADS;
    return most;
}
)";

// Squares of what is to vanish: of the worst bond, not their sum, which would leave more to one bond of a large
// molecule. The same rules as of a single work-item.
const char residuals[] = R"(
DEVICE mixed residual_of_positions@(GLOBAL const mixed* RESTRICT c, MOLECULE) {
    mixed worst = 0;
    for EACH(k, 0, N_BONDS) {
        const mixed3 v = make_mixed3(s[3*k], s[3*k+1], s[3*k+2]) + difference@(k, THE_MOLECULE);
        const mixed e = 0.5f - 0.5f*c[k]*dot(v, v);
        g[k] = (real) e;
        d[3*k] = (real) (c[k]*v.x);
        d[3*k+1] = (real) (c[k]*v.y);
        d[3*k+2] = (real) (c[k]*v.z);
        KEEP_LARGER(e*e, worst);
    }
    return worst;
}

DEVICE mixed residual_of_velocities@(MOLECULE) {
    mixed worst = 0;
    for EACH(k, 0, N_BONDS) {
        const mixed e = -dot(make_mixed3(s[3*k], s[3*k+1], s[3*k+2]), difference@(k, THE_MOLECULE));
        g[k] = (real) e;
        KEEP_LARGER(e*e, worst);
    }
    return worst;
}

// What velocities carry, of the bond with most.
DEVICE mixed carried_by_velocities@(MOLECULE) {
    mixed most = 0;
    for EACH(k, 0, N_BONDS) {
        const int i = 3*ENDS[2*k], j = 3*ENDS[2*k+1];
        mixed length = 0, speed = 0;
        for (int axis = 0; axis < 3; ++axis) {
            d[3*k+axis] = (real) s[3*k+axis];
            length += s[3*k+axis]*s[3*k+axis];
            speed += u[i+axis]*u[i+axis] + u[j+axis]*u[j+axis];
        }
        KEEP_LARGER(length*speed, most);
    }
    return most;
}
#define SOLVED(error, before, pass) \
    ((error) <= rounding || ((error) <= 1000*rounding && 4*(error) >= (before) && (pass) > 0))
)";

const char kernel_begin[] = R"(
    LOCAL mixed found[GROUP];
#if ROOM > 0
    LOCAL mixed own[ROOM];
#endif
    for (int molecule = GROUP_ID; molecule < integers[FIRST + 1]; molecule += NUM_GROUPS) {
        GLOBAL const int* RESTRICT of_molecule = integers + integers[FIRST] + 3*molecule;
        GLOBAL const int* RESTRICT table = integers + of_molecule[0];
        GLOBAL const int* RESTRICT row = integers + of_molecule[1];
        GLOBAL const int* RESTRICT atom = row + 1;
        GLOBAL const mixed* RESTRICT w = numbers + row[0];
#if ROOM > 0
        LOCAL_ARG mixed* u = own;
#else
        GLOBAL mixed* u = scratch + of_molecule[2];
#endif
        SCRATCH_ARG mixed* s = u + 3*N_ATOMS;
        SCRATCH_ARG real* d = (SCRATCH_ARG real*) (s + 3*N_BONDS);
        SCRATCH_ARG real* g = d + 3*N_BONDS;
        SCRATCH_ARG real* inverse = g + N_BONDS;
        SCRATCH_ARG real* upper = inverse + N_BONDS;
        SCRATCH_ARG real* lower = SYMMETRIC ? upper : upper + ROWS[N_BONDS];
        for EACH(i, 0, N_ATOMS) {
            const HOL_STATE moved = READ(atom[i]);
            u[3*i] = moved.x;
            u[3*i+1] = moved.y;
            u[3*i+2] = moved.z;
        }
        for EACH(k, 0, N_BONDS) {
            const int i = atom[ENDS[2*k]], j = atom[ENDS[2*k+1]];
            mixed3 bond = HOL_POSITION(i) - HOL_POSITION(j);
            bond = HOL_IMAGE(bond);
            s[3*k] = bond.x;
            s[3*k+1] = bond.y;
            s[3*k+2] = bond.z;
        }
        SYNC_THREADS;
)";
const char kernel_end[] = R"(
        if (solved) {
            for EACH(i, 0, N_ATOMS) {
                const HOL_STATE before = READ(atom[i]);
                const mixed3 after = make_mixed3(u[3*i], u[3*i+1], u[3*i+2]);
                WRITE(atom[i], before, after);
            }
        } else if (LOCAL_ID == 0)
            HOL_FAILED(atom[N_ATOMS])
        SYNC_THREADS;
    }
}
)";

const char positions[] = R"(
        const mixed rounding = 4*HOL_ROUNDING*HOL_ROUNDING;
        GLOBAL const mixed* RESTRICT c = w + N_ATOMS;
        mixed error = largest@(residual_of_positions@(c, THE_MOLECULE), found);
        int solved = error <= rounding;
        for (int pass = 1; pass < HOL_MOST_PASSES && !solved; ++pass) {
            const mixed last = error;
            move_by@(1, THE_MOLECULE);
            error = largest@(residual_of_positions@(c, THE_MOLECULE), found);
            solved = SOLVED(error, last, pass);
        }
)";
const char velocities[] = R"(
        const mixed rounding = largest@(carried_by_velocities@(THE_MOLECULE), found)*(HOL_ROUNDING*HOL_ROUNDING/16);
        mixed error = largest@(residual_of_velocities@(THE_MOLECULE), found);
        int solved = error <= rounding;
        for (int pass = 1; pass < HOL_MOST_PASSES && !solved; ++pass) {
            const mixed last = error;
            move_by@(pass == 1, THE_MOLECULE);
            error = largest@(residual_of_velocities@(THE_MOLECULE), found);
            solved = SOLVED(error, last, pass);
        }
)";

// Words of these kernels alone: a program that goes on behind the text may have its own of these names.
const char *const short_names[] = {"MOLECULE", "THE_MOLECULE", "N_ATOMS",   "N_BONDS", "N_LEVELS",
                                   "EACH",     "KEEP_LARGER",  "SOLVED",    "FIRST",   "GROUP",
                                   "ROOM",     "SCRATCH_ARG",  "SYMMETRIC", "READ",    "WRITE"};

std::string undefined(const std::string &name) { return "#undef " + name + "\n"; }

std::string redefined(const std::string &name, const std::string &as) {
    return undefined(name.substr(0, name.find('('))) + "#define " + name + " " + as + "\n";
}

}  // namespace

std::string group_kernels(int launch, int group_size, int room) {
    const std::string number = std::to_string(launch);
    std::string text = redefined("FIRST", std::to_string(2 * launch)) + redefined("GROUP", std::to_string(group_size)) +
                       redefined("ROOM", std::to_string(room)) +
                       redefined("SCRATCH_ARG", room > 0 ? "LOCAL_ARG" : "GLOBAL");
    int part = 0;
    for (const char *const name : parts_of_table)
        text += redefined(name, "(table + table[" + std::to_string(part++) + "])");
    text += solution;
    text += residuals;
    for (const bool of_velocities : {false, true}) {
        text += redefined("SYMMETRIC", of_velocities ? "1" : "0");
        text += redefined("READ(a)", of_velocities ? "HOL_VELOCITY(a)" : "HOL_DISPLACEMENT(a)");
        text += redefined("WRITE(a, before, after)",
                          of_velocities ? "HOL_SET_VELOCITY(a, before, after)" : "HOL_DISPLACE(a, before, after)");
        text += of_velocities ? "KERNEL void hol_velocities@(HOL_PLAN, HOL_VELOCITY_ARRAYS) {"
                              : "KERNEL void hol_positions@(HOL_PLAN, HOL_POSITION_ARRAYS) {";
        text += kernel_begin;
        text += of_velocities ? velocities : positions;
        text += kernel_end;
    }
    for (const char *const name : parts_of_table) text += undefined(name);
    for (const char *const name : short_names) text += undefined(name);
    for (std::size_t mark; (mark = text.find('@')) != std::string::npos;) text.replace(mark, 1, "_" + number);
    return text;
}

}  // namespace holonomic::device
