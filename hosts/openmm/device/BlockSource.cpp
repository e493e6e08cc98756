#include <sstream>

#include "BlockPlan.h"
#include "Source.h"

namespace OpenMM {

namespace {

// A molecule is solved by the threads of a block, and its numbers stand where all of them see them: displacements or
// velocities u of the atoms, bonds s; of the matrix the rows' vectors d, the right-hand side and then the solution g,
// the pivots' inverses, and the entries above and below the diagonal. Each number is written by one thread, sums have
// one order, and a level waits for the one before: nothing depends on which thread comes first.
const char solution[] = R"(
#define MOLECULE GLOBAL const int* RESTRICT plan, GLOBAL const mixed* RESTRICT w, SCRATCH_ARG mixed* u, \
    SCRATCH_ARG mixed* s, SCRATCH_ARG real* d, SCRATCH_ARG real* g, SCRATCH_ARG real* inverse, \
    SCRATCH_ARG real* upper, SCRATCH_ARG real* lower
#define THE_MOLECULE plan, w, u, s, d, g, inverse, upper, lower
#define N_ATOMS SIZES[0]
#define N_BONDS SIZES[1]
#define N_LEVELS SIZES[2]
#define EACH(i, first, last) (int i = (first) + LOCAL_ID; i < (last); i += LOCAL_SIZE)

DEVICE real alongBond(int row, int column, MOLECULE) {
    return d[3*row]*(real) s[3*column] + d[3*row+1]*(real) s[3*column+1] + d[3*row+2]*(real) s[3*column+2];
}

DEVICE mixed3 difference(int k, MOLECULE) {
    const int i = 3*ENDS[2*k], j = 3*ENDS[2*k+1];
    return make_mixed3(u[i]-u[j], u[i+1]-u[j+1], u[i+2]-u[j+2]);
}

// The pivot of a bond, and its right-hand side.
DEVICE void reducePivot(int k, int factorize, MOLECULE) {
    real right = g[k];
    real pivot = factorize ? (real) (w[ENDS[2*k]] + w[ENDS[2*k+1]])*alongBond(k, k, THE_MOLECULE) : 0;
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

DEVICE void reduceEntry(int p, MOLECULE) {
    const int k = ENTRIES[2*p], l = ENTRIES[2*p+1], shared = SHARED[p];
    const real weight = shared > 0 ? (real) w[shared-1] : shared < 0 ? -(real) w[-shared-1] : 0;
    real up = 0, down = 0;
    if (shared != 0) {
        up = weight*alongBond(k, l, THE_MOLECULE);
        down = weight*alongBond(l, k, THE_MOLECULE);
    }
    for (int t = TERMS[p]; t < TERMS[p+1]; ++t) {
        const int q = TERM_ENTRIES[3*t], r = TERM_ENTRIES[3*t+1];
        const real i = inverse[TERM_ENTRIES[3*t+2]];
        up -= lower[q]*i*upper[r];
        down -= lower[r]*i*upper[q];
    }
    upper[p] = up;
    if (!SYMMETRIC)
        lower[p] = down;
}

// The multipliers g for the right-hand side g, and what they do to u.
DEVICE void moveBy(int factorize, MOLECULE) {
    for (int level = 0; level < N_LEVELS; ++level) {
        const int first = LEVELS[level], last = LEVELS[level+1];
        for EACH(k, first, last)
            reducePivot(k, factorize, THE_MOLECULE);
        if (factorize)
            for EACH(p, ROWS[first], ROWS[last])
                reduceEntry(p, THE_MOLECULE);
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

DEVICE mixed largest(mixed most, LOCAL_ARG mixed* found) {
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
// molecule. The same rules as of a single thread.
const char residuals[] = R"(
DEVICE mixed residualOfPositions(GLOBAL const mixed* RESTRICT c, MOLECULE) {
    mixed worst = 0;
    for EACH(k, 0, N_BONDS) {
        const mixed3 v = make_mixed3(s[3*k], s[3*k+1], s[3*k+2]) + difference(k, THE_MOLECULE);
        const mixed e = 0.5f - 0.5f*c[k]*dot(v, v);
        g[k] = e;
        d[3*k] = c[k]*v.x;
        d[3*k+1] = c[k]*v.y;
        d[3*k+2] = c[k]*v.z;
        KEEP_LARGER(e*e, worst);
    }
    return worst;
}

DEVICE mixed residualOfVelocities(MOLECULE) {
    mixed worst = 0;
    for EACH(k, 0, N_BONDS) {
        const mixed e = -dot(make_mixed3(s[3*k], s[3*k+1], s[3*k+2]), difference(k, THE_MOLECULE));
        g[k] = e;
        KEEP_LARGER(e*e, worst);
    }
    return worst;
}

// What velocities carry, of the bond with most.
DEVICE mixed carriedByVelocities(MOLECULE) {
    mixed most = 0;
    for EACH(k, 0, N_BONDS) {
        const int i = 3*ENDS[2*k], j = 3*ENDS[2*k+1];
        mixed length = 0, speed = 0;
        for (int axis = 0; axis < 3; ++axis) {
            d[3*k+axis] = s[3*k+axis];
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

const char kernelBegin[] = R"(
KERNEL void solve@(int firstSlot, int lastSlot, GLOBAL const int4* RESTRICT blocks, GLOBAL const int* RESTRICT atoms,
        GLOBAL const mixed* RESTRICT parameters, GLOBAL int* RESTRICT failures, GLOBAL int* RESTRICT anyFailure,
        int call, GLOBAL mixed4* RESTRICT state, GLOBAL const int* RESTRICT plans, SCRATCH_ARRAYS POSITIONS) {
    LOCAL mixed found[BLOCK];
    OWN_SCRATCH
    for (int slot = firstSlot + GROUP_ID; slot < lastSlot; slot += NUM_GROUPS) {
        const int4 block = blocks[slot - FIRST_BLOCK];
        GLOBAL const int* RESTRICT plan = plans + block.x;
        GLOBAL const int* RESTRICT atom = atoms + block.y;
        GLOBAL const mixed* RESTRICT w = parameters + atom[N_ATOMS];
        SCRATCH_ARG mixed* u = MIXED_SCRATCH;
        SCRATCH_ARG mixed* s = u + 3*N_ATOMS;
        SCRATCH_ARG real* d = REAL_SCRATCH;
        SCRATCH_ARG real* g = d + 3*N_BONDS;
        SCRATCH_ARG real* inverse = g + N_BONDS;
        SCRATCH_ARG real* upper = inverse + N_BONDS;
        SCRATCH_ARG real* lower = SYMMETRIC ? upper : upper + ROWS[N_BONDS];
        for EACH(i, 0, N_ATOMS) {
            const mixed4 moved = state[atom[i]];
            u[3*i] = moved.x;
            u[3*i+1] = moved.y;
            u[3*i+2] = moved.z;
        }
        for EACH(k, 0, N_BONDS) {
            const int i = atom[ENDS[2*k]], j = atom[ENDS[2*k+1]];
            const mixed3 bond = POSITION(i) - POSITION(j);
            s[3*k] = bond.x;
            s[3*k+1] = bond.y;
            s[3*k+2] = bond.z;
        }
        SYNC_THREADS;
)";
const char kernelEnd[] = R"(
        if (solved) {
            for EACH(i, 0, N_ATOMS)
                state[atom[i]] = make_mixed4(u[3*i], u[3*i+1], u[3*i+2], state[atom[i]].w);
        } else if (LOCAL_ID == 0 && failures[slot] == 0) {
            failures[slot] = call;
            anyFailure[0] = 1;
        }
        SYNC_THREADS;
    }
}
)";

const char positions[] = R"(
        const mixed rounding = 4*ROUNDING*ROUNDING;
        GLOBAL const mixed* RESTRICT c = w + N_ATOMS;
        mixed error = largest(residualOfPositions(c, THE_MOLECULE), found);
        int solved = error <= rounding;
        for (int pass = 1; pass < MAX_ITERATIONS && !solved; ++pass) {
            const mixed before = error;
            moveBy(1, THE_MOLECULE);
            error = largest(residualOfPositions(c, THE_MOLECULE), found);
            solved = SOLVED(error, before, pass);
        }
)";
const char velocities[] = R"(
        const mixed rounding = largest(carriedByVelocities(THE_MOLECULE), found)*(ROUNDING*ROUNDING/16);
        mixed error = largest(residualOfVelocities(THE_MOLECULE), found);
        int solved = error <= rounding;
        for (int pass = 1; pass < MAX_ITERATIONS && !solved; ++pass) {
            const mixed before = error;
            moveBy(pass == 1, THE_MOLECULE);
            error = largest(residualOfVelocities(THE_MOLECULE), found);
            solved = SOLVED(error, before, pass);
        }
)";

}  // namespace

std::string blockSource(bool ofVelocities, int blockSize, int firstBlock, const LocalScratch &scratch) {
    std::ostringstream text;
    text << commonSource << "#define BLOCK " << blockSize << "\n#define FIRST_BLOCK " << firstBlock
         << "\n#define SYMMETRIC " << ofVelocities << "\n";
    int part = 0;
    for (const char *name : partsOfPlan) text << "#define " << name << " (plan + plan[" << part++ << "])\n";
    if (scratch.nReals > 0)
        text << "#define SCRATCH_ARG LOCAL_ARG\n#define SCRATCH_ARRAYS\n#define OWN_SCRATCH LOCAL mixed ownMixed["
             << scratch.nMixed << "]; LOCAL real ownReals[" << scratch.nReals
             << "];\n#define MIXED_SCRATCH ownMixed\n#define REAL_SCRATCH ownReals\n";
    else
        text << "#define SCRATCH_ARG GLOBAL\n#define OWN_SCRATCH\n#define SCRATCH_ARRAYS GLOBAL mixed* mixedScratch, "
                "GLOBAL real* realScratch,\n#define MIXED_SCRATCH (mixedScratch + block.z)\n"
                "#define REAL_SCRATCH (realScratch + block.w)\n";
    std::string kernel = kernelBegin;
    kernel.replace(kernel.find('@'), 1, ofVelocities ? "Velocities" : "Positions");
    text << solution << residuals << kernel << (ofVelocities ? velocities : positions) << kernelEnd;
    return text.str();
}

}  // namespace OpenMM
