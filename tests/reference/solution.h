/**
 * @file solution.h
 * Independent solutions to compare the library with: the equations as in docs/theory.md, set up as matrices from the
 * raw inputs and solved by textbook elimination in 113-bit arithmetic. One chain per call.
 *
 * Scales. The error that a double-precision program may make is measured against a scale per number: how much relative
 * changes of the size of rounding in the inputs can move it, were they all to add up. With |Z^-1| the matrix of
 * absolute values, lambda_scale_k = sum_l |Z^-1|_kl S_l, S_l            = 2 sum_x |d_l,x| (w_l |f_l,x| + w_{l-1}
 * |f_{l-1},x|) + 2 |v_l - v_{l-1}|^2      (acceleration level) S_l            = 2 sum_x |d_l,x| (|v_l,x| + |v_{l-1},x|)
 * (velocity level) g_scale_i      = 2 (lambda_scale_i |d_i| + lambda_scale_{i+1} |d_{i+1}|) virial_scale   = sum_k 2
 * lambda_scale_k |d_k|^2 fixman_scale_i = p_i + p_{i+1},  p_k = (|h_k| |n_k| + |h_{k+1}| |n_{k+1}|) / |d_k|, h_k =
 * w_{k-1} (M^-1)_{k-1,k},  n_k = u_{k-1} x u_k The first kind and the last reproduce every scale printed in
 * tests/oracle to its six digits.
 */
#ifndef REFERENCE_SOLUTION_H
#define REFERENCE_SOLUTION_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** One chain. */
typedef struct solution_problem {
    int64_t n_bonds;
    const double *mass;         /**< [n_bonds+1], 0 = held fixed */
    const double *inverse_mass; /**< [n_bonds+1], used instead of mass if not NULL */
    const double *r;            /**< [n_bonds+1][3] */
    const double *v, *f;        /**< [n_bonds+1][3] or NULL */
    const double *box;          /**< [3][3] or NULL; bonds are the shortest image, found by trying the images */
} solution_problem;

/** Multipliers and what follows from them. Free with solution_free. */
typedef struct solution {
    int64_t n_bonds;
    long double *lambda, *lambda_scale; /**< [n_bonds] */
    long double *tension;               /**< [n_bonds] */
    long double *g;                     /**< [n_bonds+1][3] */
    long double *g_scale;               /**< [n_bonds+1] */
    long double virial[9], virial_scale;
} solution;

/** Z lambda = K + C. Returns 0, or -1 if Z is singular or there is no memory. */
int solution_forces(const solution_problem *p, solution *out);

/** Z lambda = 2 d . dv; g is the impulse m dv. v must be given. */
int solution_velocities(const solution_problem *p, solution *out);

/**
 * Position level: Newton's method from lambda = 0 with the full Jacobian, until nothing changes in 113 bits.
 * p->r are the reference positions.
 * @param[in]  drifted     [n_bonds+1][3]
 * @param[in]  length      [n_bonds]
 * @param[in]  dt
 * @param[out] positions   [n_bonds+1][3], constrained
 * @param[out] out         lambda, g, tension, virial; the scales are zero
 * @return number of iterations, or -1: no convergence
 */
int solution_positions(const solution_problem *p, const double *drifted, const double *length, double dt,
                       long double *positions, solution *out);

void solution_free(solution *s);

/** Metric of one chain. Free with solution_metric_free. */
typedef struct solution_metric {
    long double log_det;           /**< ln det Z~ */
    long double *fixman_force;     /**< [n_bonds+1][3], in units of kT */
    long double *fixman_scale;     /**< [n_bonds+1] */
    long double condition;         /**< of Z~, infinity norm */
    long double *inverse_diagonal; /**< [n_bonds] of Z~^-1 */
} solution_metric;

/** O(n_bonds^2). Returns 0 or -1. */
int solution_metric_make(const solution_problem *p, solution_metric *out);

void solution_metric_free(solution_metric *m);

/**
 * The Fixman force in units of kT by differences of ln det Z~, fourth order in steps of 1e-8 of a bond: it knows
 * nothing of the formula for the gradient.
 * @param[out] force [n_bonds+1][3]
 */
int solution_fixman_differences(const solution_problem *p, long double *force);

/** Column `column` (from 0) of Z~^-1 [n_bonds]. Returns 0 or -1. */
int solution_inverse_column(const solution_problem *p, int64_t column, long double *values);

/** Inverses of Z~ and ln det Z~ lose digits in proportion to the condition number; a caller can ask for what is left.
 */
long double solution_epsilon(void);

#ifdef __cplusplus
}
#endif
#endif
