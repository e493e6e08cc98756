/** Molecules for the kernels of a plan: some for a work-item, for a work-group, with held atoms, and for the host. */
#ifndef DEVICE_SCENE_H
#define DEVICE_SCENE_H

#include <holonomic.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Those of molecules that kernels solve come first. */
enum { SCENE_ON_DEVICE = 3 * 70 + 14 + 31 + 121 + 701 + 7, SCENE_ATOMS = SCENE_ON_DEVICE + 3 + 81, SCENE_LEFT = 2 };

typedef struct scene {
    hol_chains *chains;
    int n_atoms, n_bonds;
    double mass[SCENE_ATOMS], r[3 * SCENE_ATOMS], v[3 * SCENE_ATOMS]; /* on the constraints, and along them */
    int64_t pair[2 * (SCENE_ATOMS + 70)];
    double length[SCENE_ATOMS + 70];
} scene;

/** Ends the program if a call fails. */
void scene_make(scene *s);
hol_device_plan *scene_plan(const scene *s, hol_device_precision precision);

#ifdef __cplusplus
}
#endif
#endif
