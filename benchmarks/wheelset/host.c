/* Times a wheelset's outputs, generated and plain, on the same inputs.
 * Arguments: file of doubles: parameters, then rows of inputs; number of rows; law (1 linear, 4 polach,
 * 5 fastsim). Prints for each round the nanoseconds of one evaluation: generated, plain. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "block.h"

#define CASADI_SYMBOL_EXPORT static
#include "equations.h"

#include "plain.h"

enum { ROUNDS = 15 };

static double p[N_PARAMETERS], d[N_DERIVED + 1], y[N_OUTPUTS], sink;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int main(int count, char **given) {
    static const double *arg[WORK_ARG + 8];
    static double *res[WORK_RES + 8], w[WORK_W + 8];
    static casadi_int iw[WORK_IW + 8];
    if (count != 4) return 2;
    int rows = atoi(given[2]), law = atoi(given[3]);
    double *u = malloc(sizeof(double) * (size_t)rows * N_INPUTS);
    FILE *file = fopen(given[1], "rb");
    if (!u || !file || fread(p, sizeof *p, N_PARAMETERS, file) != N_PARAMETERS) return 2;
    if (fread(u, sizeof *u, (size_t)rows * N_INPUTS, file) != (size_t)rows * N_INPUTS) return 2;
    arg[0] = p;
    res[0] = d;
    derived(arg, res, iw, w, 0);
    plain_prepare();
    for (int round = 0; round < ROUNDS; round++) {
        double start = now();
        for (int i = 0; i < rows; i++) {
            arg[0] = 0, arg[1] = u + i * N_INPUTS, arg[2] = p, arg[3] = d, arg[4] = 0;
            res[0] = y;
            outputs(arg, res, iw, w, 0);
            sink += y[0];
        }
        double generated = now();
        for (int i = 0; i < rows; i++) sink += plain(law, u + i * N_INPUTS);
        double end = now();
        printf("%.17g %.17g\n", (generated - start) / rows, (end - generated) / rows);
    }
    return sink == 42.0;
}
