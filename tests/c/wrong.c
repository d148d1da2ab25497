/* All that can be called wrongly, outside of a run without an argument, else in one: `wrong diverged|close|leave`. */
#include "halfstep.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPECT(code, call)                                                                                     \
    do {                                                                                                       \
        int found = (call);                                                                                    \
        if (found != (code) || (found < 0 && strlen(halfstep_error()) == 0)) {                                 \
            printf("%s is %d: %s\n", #call, found, halfstep_error());                                          \
            exit(1);                                                                                           \
        }                                                                                                      \
    } while (0)

#define MOST 100000
static double x[3 * MOST], v[3 * MOST], f[3 * MOST], s[6 * MOST], mass[MOST], density[MOST];
static uint8_t clamped[MOST];
static uint32_t body[MOST];

static void outside(void)
{
    size_t n;
    halfstep_step step;
    EXPECT(HALFSTEP_RUN, halfstep_particle_count(&n));
    printf("%s\n", halfstep_error());
    EXPECT(HALFSTEP_RUN, halfstep_open(1, x, v, mass, density, NULL, 0));
    EXPECT(HALFSTEP_STATE, halfstep_wait(&step, 1, f));
    EXPECT(HALFSTEP_STATE, halfstep_publish(1, x, v));
    EXPECT(HALFSTEP_STATE, halfstep_stress(1, s));
    EXPECT(HALFSTEP_STATE, halfstep_dt_limit(1.0));
    EXPECT(HALFSTEP_STATE, halfstep_sub_steps(1));
    EXPECT(HALFSTEP_STATE, halfstep_stored_energy(1.0));
    EXPECT(HALFSTEP_STATE, halfstep_pressure(1, s));
    EXPECT(HALFSTEP_RUN, halfstep_saved("x", 1, x));
    EXPECT(HALFSTEP_RUN, halfstep_particle_bodies(1, body));
    EXPECT(HALFSTEP_STATE, halfstep_diverged(HALFSTEP_SPEED, 0, 1.0));
    EXPECT(HALFSTEP_OK, halfstep_close());
}

int main(int argc, char **argv)
{
    size_t n;
    halfstep_step step;
    if (argc < 2) {
        outside();
        return 0;
    }
    EXPECT(HALFSTEP_POINTER, halfstep_particle_count(NULL));
    EXPECT(HALFSTEP_OK, halfstep_particle_count(&n));
    EXPECT(HALFSTEP_COUNT, halfstep_particles(n + 1, x, v, mass, density, clamped));
    EXPECT(HALFSTEP_POINTER, halfstep_particles(n, x, v, mass, NULL, clamped));
    EXPECT(HALFSTEP_OK, halfstep_particles(n, x, v, mass, density, clamped));
    EXPECT(HALFSTEP_COUNT, halfstep_open(0, x, v, mass, density, NULL, 0));
    EXPECT(HALFSTEP_COUNT, halfstep_open(SIZE_MAX, x, v, mass, density, NULL, 0));
    EXPECT(HALFSTEP_POINTER, halfstep_open(n, x, NULL, mass, density, NULL, 0));
    EXPECT(HALFSTEP_POINTER, halfstep_open(n, (double *)((char *)x + 1), v, mass, density, NULL, 0));
    mass[1] = -mass[0];
    EXPECT(HALFSTEP_VALUE, halfstep_open(n, x, v, mass, density, NULL, 0));
    mass[1] = mass[0];
    x[4] = NAN;
    EXPECT(HALFSTEP_VALUE, halfstep_open(n, x, v, mass, density, NULL, 0));
    x[4] = x[1];
    EXPECT(HALFSTEP_OK, halfstep_particles(n, x, v, mass, density, clamped));
    EXPECT(HALFSTEP_POINTER, halfstep_keep(NULL, 1, x));
    EXPECT(HALFSTEP_POINTER, halfstep_keep("x", 1, NULL));
    x[4] = NAN;
    EXPECT(HALFSTEP_VALUE, halfstep_keep("x", 3 * n, x));
    x[4] = x[1];
    EXPECT(HALFSTEP_OK, halfstep_particles(n, x, v, mass, density, clamped));
    EXPECT(HALFSTEP_COUNT, halfstep_particle_bodies(n + 1, body));
    EXPECT(HALFSTEP_OK, halfstep_particle_bodies(n, body));
    EXPECT(HALFSTEP_OK, halfstep_bodies(n - 1, body));
    EXPECT(HALFSTEP_COUNT, halfstep_open(n, x, v, mass, density, clamped, 1));
    EXPECT(HALFSTEP_OK, halfstep_bodies(n, body));
    EXPECT(HALFSTEP_NOTHING, halfstep_saved("x", 1, s));
    EXPECT(HALFSTEP_OK, halfstep_open(n, x, v, mass, density, clamped, 1));
    EXPECT(HALFSTEP_STATE, halfstep_bodies(n, body));
    EXPECT(HALFSTEP_STATE, halfstep_keep("x", 1, x));
    EXPECT(HALFSTEP_VALUE, halfstep_sub_steps(0));
    EXPECT(HALFSTEP_OK, halfstep_sub_steps(3));
    EXPECT(HALFSTEP_VALUE, halfstep_stored_energy(NAN));
    EXPECT(HALFSTEP_OK, halfstep_stored_energy(1.5));
    EXPECT(HALFSTEP_COUNT, halfstep_pressure(n - 1, s));
    EXPECT(HALFSTEP_VALUE, halfstep_density(n, s));
    EXPECT(HALFSTEP_OK, halfstep_density(n, density));
    EXPECT(HALFSTEP_STATE, halfstep_open(n, x, v, mass, density, clamped, 1));
    EXPECT(HALFSTEP_STATE, halfstep_publish(n, x, v));
    EXPECT(HALFSTEP_VALUE, halfstep_dt_limit(0.0));
    EXPECT(HALFSTEP_OK, halfstep_dt_limit(1e-4));
    EXPECT(HALFSTEP_OK, halfstep_stress(n, s));
    for (int k = 0; k < 5; k++) {
        EXPECT(HALFSTEP_COUNT, halfstep_wait(&step, n - 1, f));
        EXPECT(HALFSTEP_POINTER, halfstep_wait(NULL, n, f));
        EXPECT(HALFSTEP_POINTER, halfstep_wait(&step, n, NULL));
        EXPECT(HALFSTEP_OK, halfstep_wait(&step, n, f));
        EXPECT(HALFSTEP_STATE, halfstep_wait(&step, n, f));
        if (k == 4)
            break;
        v[0] = INFINITY;
        EXPECT(HALFSTEP_VALUE, halfstep_publish(n, x, v));
        v[0] = 0.0;
        EXPECT(HALFSTEP_COUNT, halfstep_publish(n + 1, x, v));
        EXPECT(HALFSTEP_OK, halfstep_publish(n, x, v));
    }
    if (step.number != 2 || step.stage != 0 || step.dt <= 0.0 || step.dt > 1e-4 || step.span != step.dt / 2) {
        printf("step %d, stage %d, dt %g s\n", (int)step.number, (int)step.stage, step.dt);
        return 1;
    }
    if (strcmp(argv[1], "diverged") == 0) {
        EXPECT(HALFSTEP_COUNT, halfstep_diverged(HALFSTEP_SPEED, (uint32_t)n, 70.0));
        EXPECT(HALFSTEP_VALUE, halfstep_diverged(7, 3, 70.0));
        EXPECT(HALFSTEP_OK, halfstep_diverged(HALFSTEP_SPEED, 3, 70.0));
        EXPECT(HALFSTEP_STATE, halfstep_publish(n, x, v));
    }
    if (strcmp(argv[1], "leave") != 0) {
        EXPECT(HALFSTEP_OK, halfstep_close());
        EXPECT(HALFSTEP_STATE, halfstep_publish(n, x, v));
    }
    return 0;
}
