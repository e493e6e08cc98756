/**
 * @file physics.h
 * What physics demands of the answers of a scene, by sums of their own: nothing here solves for multipliers.
 */
#ifndef TESTS_PHYSICS_H
#define TESTS_PHYSICS_H

#include "scene.h"

/** Each deviation in units of what rounding explains. */
typedef enum deviation {
    SECOND_DERIVATIVE = 0, /**< of d.d, with G: d.(a_k - a_{k-1}) + |v_k - v_{k-1}|^2 */
    PULLS,                 /**< G_i against 2 (lambda_{i+1} d_{i+1} - lambda_i d_i) */
    TENSIONS,              /**< against 2 lambda |d| */
    RATES,                 /**< d.(v_k - v_{k-1}) after the projection */
    CHANGES,               /**< of velocities, against w_i 2 (lambda_{i+1} d_{i+1} - lambda_i d_i) */
    LENGTHS,               /**< |d.d - a^2| after the projection */
    MOVES,                 /**< of atoms, against 2 dt^2 w_i (lambda_{i+1} b_{i+1} - lambda_i b_i) */
    PUSHES,                /**< changes of velocities there, against those of positions over dt */
    VIRIALS,               /**< all three, against - sum 2 lambda_k d_k (x) d_k */
    LOGARITHMS,            /**< of det Z~ and det Z, against a recursion in long double */
    ENERGY,                /**< against kT/2 times the sum of ln det Z~ */
    FIXMAN_FORCE, /**< against a difference of ln det Z~ along a random direction, in units of 1e-6 of the force */
    FIXMAN_SUM,   /**< the sum of the Fixman force over a chain */
    DEVIATIONS
} deviation;

extern const char *const deviation_names[DEVIATIONS];

/** The largest of each that has been seen. */
typedef struct deviations {
    double worst[DEVIATIONS];
} deviations;

/** Raises x by the deviations of these answers; `plain`: without tensions and sums over chains. */
void deviations_add(deviations *x, const scene *s, const answers *a, int plain);

#endif
