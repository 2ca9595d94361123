/* The least that any master does with the ring, in plain C: gather the inputs, set, step, read the
 * outputs into the record. Of FMI 2.0 or, with -DFMI3, of FMI 3.0. floor LIBRARY STEPS STEP_SIZE RECORD_FILE, and on standard input mass,
 * start x and start y of each block; prints the seconds that the steps took. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BLOCKS = 8, INPUTS = 6, OUTPUTS = 8, WIDTH = BLOCKS * OUTPUTS };

typedef int (*Mode)(void *);
#ifndef FMI3
#define NAME(rest) "fmi2" rest
#define REAL "Real"
#define INSTANTIATE "Instantiate"
#define ALL(count)
#define SAID
typedef void *(*Instantiate)(const char *, int, const char *, const char *, const void *, int, int);
typedef int (*Set)(void *, const uint32_t *, size_t, const double *);
typedef int (*Get)(void *, const uint32_t *, size_t, double *);
typedef int (*DoStep)(void *, double, double, int);
#else
#define NAME(rest) "fmi3" rest
#define REAL "Float64"
#define INSTANTIATE "InstantiateCoSimulation"
#define ALL(count) , count
#define SAID , said, said + 1, said + 2, &last
typedef void *(*Instantiate)(const char *, int, const char *, const char *, const void *, int, int);
typedef int (*Set)(void *, const uint32_t *, size_t, const double *, size_t);
typedef int (*Get)(void *, const uint32_t *, size_t, double *, size_t);
typedef int (*DoStep)(void *, double, double, bool, bool *, bool *, bool *, double *);
static bool said[3];
static double last;
#endif

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int count, char **word) {
    static const uint32_t input[INPUTS] = {0, 1, 2, 3, 4, 5}, output[OUTPUTS] = {6, 7, 8, 9, 10, 11, 12, 13};
    static const uint32_t parameter[3] = {14, 20, 21};
    if (count != 5) return 2;
    void *library = dlopen(word[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return 3;
    int steps = atoi(word[2]), failed = 0, source[BLOCKS][INPUTS];
    double size = atof(word[3]), u[INPUTS];
    Instantiate instantiate = (Instantiate)dlsym(library, NAME(INSTANTIATE));
    Mode enter = (Mode)dlsym(library, NAME("EnterInitializationMode"));
    Mode leave = (Mode)dlsym(library, NAME("ExitInitializationMode"));
    Set set = (Set)dlsym(library, NAME("Set" REAL));
    Get get = (Get)dlsym(library, NAME("Get" REAL));
    DoStep do_step = (DoStep)dlsym(library, NAME("DoStep"));
    void *block[BLOCKS];
    size_t record_size = sizeof(double) * WIDTH * (size_t)(steps + 1);
    double *record = malloc(record_size);
    memset(record, 0, record_size);
    for (int i = 0; i < BLOCKS; i++) {
        double given[3];
        if (scanf("%lf %lf %lf", given, given + 1, given + 2) != 3) return 4;
        block[i] = instantiate("block", 1, "", "", NULL, 0, 0);
        failed |= set(block[i], parameter, 3, given ALL(3)) | enter(block[i]) | leave(block[i]);
        failed |= get(block[i], output, OUTPUTS, record + i * OUTPUTS ALL(OUTPUTS));
        for (int j = 0; j < INPUTS; j++) /* x, vx, y of the left neighbour, then of the right one */
            source[i][j] = (i + (j < 3 ? BLOCKS - 1 : 1)) % BLOCKS * OUTPUTS + j % 3;
    }
    double begin = seconds();
    for (int k = 0; k < steps; k++) {
        const double *now = record + (size_t)k * WIDTH;
        double *next = record + (size_t)(k + 1) * WIDTH;
        for (int i = 0; i < BLOCKS; i++) {
            for (int j = 0; j < INPUTS; j++) u[j] = now[source[i][j]];
            failed |= set(block[i], input, INPUTS, u ALL(INPUTS));
            failed |= do_step(block[i], k * size, size, 1 SAID);
            failed |= get(block[i], output, OUTPUTS, next + i * OUTPUTS ALL(OUTPUTS));
        }
    }
    double spent = seconds() - begin;
    FILE *file = fopen(word[4], "wb");
    if (!file || failed || fwrite(record, 1, record_size, file) != record_size) return 5;
    fclose(file);
    printf("%.9f\n", spent);
    return 0;
}
