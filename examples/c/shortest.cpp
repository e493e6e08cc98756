#include <cstdio>
#include <holonomic.hpp>

int main()
{  // three beads hang from a fixed atom (mass 0): what holds them?
    const double mass[] = {0, 1, 1, 1}, length[] = {1, 1, 1};
    const double r[] = {0, 0, 0, 0, 0, -1, 0, 0, -2, 0, 0, -3}, f[] = {0, 0, 0, 0, 0, -10, 0, 0, -10, 0, 0, -10};
    double tension[3];
    holonomic::Chains chains(mass);
    chains.add_block(1, 0, length);
    chains.forces(r, {}, f, {{}, tension});
    std::printf("tensions: %g %g %g\n", tension[0], tension[1], tension[2]);  // 30 20 10
}
