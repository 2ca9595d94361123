/* The least that any master does with the ring, in plain C: gather the inputs, set, step, read the
 * outputs into the record. floor LIBRARY STEPS STEP_SIZE RECORD_FILE, and on standard input mass,
 * start x and start y of each block; prints the seconds that the steps took. */
#include <dlfcn.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BLOCKS = 8, INPUTS = 6, OUTPUTS = 8, WIDTH = BLOCKS * OUTPUTS };

typedef void *(*Instantiate)(const char *, int, const char *, const char *, const void *, int, int);
typedef int (*Mode)(void *);
typedef int (*Set)(void *, const uint32_t *, size_t, const double *);
typedef int (*Get)(void *, const uint32_t *, size_t, double *);
typedef int (*DoStep)(void *, double, double, int);

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
    Instantiate instantiate = (Instantiate)dlsym(library, "fmi2Instantiate");
    Mode enter = (Mode)dlsym(library, "fmi2EnterInitializationMode");
    Mode leave = (Mode)dlsym(library, "fmi2ExitInitializationMode");
    Set set = (Set)dlsym(library, "fmi2SetReal");
    Get get = (Get)dlsym(library, "fmi2GetReal");
    DoStep do_step = (DoStep)dlsym(library, "fmi2DoStep");
    void *block[BLOCKS];
    size_t record_size = sizeof(double) * WIDTH * (size_t)(steps + 1);
    double *record = malloc(record_size);
    memset(record, 0, record_size);
    for (int i = 0; i < BLOCKS; i++) {
        double given[3];
        if (scanf("%lf %lf %lf", given, given + 1, given + 2) != 3) return 4;
        block[i] = instantiate("block", 1, "", "", NULL, 0, 0);
        failed |= set(block[i], parameter, 3, given) | enter(block[i]) | leave(block[i]);
        failed |= get(block[i], output, OUTPUTS, record + i * OUTPUTS);
        for (int j = 0; j < INPUTS; j++) /* x, vx, y of the left neighbour, then of the right one */
            source[i][j] = (i + (j < 3 ? BLOCKS - 1 : 1)) % BLOCKS * OUTPUTS + j % 3;
    }
    double begin = seconds();
    for (int k = 0; k < steps; k++) {
        const double *now = record + (size_t)k * WIDTH;
        double *next = record + (size_t)(k + 1) * WIDTH;
        for (int i = 0; i < BLOCKS; i++) {
            for (int j = 0; j < INPUTS; j++) u[j] = now[source[i][j]];
            failed |= set(block[i], input, INPUTS, u);
            failed |= do_step(block[i], k * size, size, 1);
            failed |= get(block[i], output, OUTPUTS, next + i * OUTPUTS);
        }
    }
    double spent = seconds() - begin;
    FILE *file = fopen(word[4], "wb");
    if (!file || failed || fwrite(record, 1, record_size, file) != record_size) return 5;
    fclose(file);
    printf("%.9f\n", spent);
    return 0;
}
