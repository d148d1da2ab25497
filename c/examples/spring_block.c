/* A rigid block on a spring along x as the solid of a run: `spring_block STIFFNESS` (N/m).
 *
 *   cc -I c/include c/examples/spring_block.c -L target/release -lhalfstep_c -o spring_block
 *   LD_LIBRARY_PATH=target/release halfstep run scenes/spring-block.toml --solid './spring_block 20000'
 */
#include "halfstep.h"

#include <stdio.h>
#include <stdlib.h>

static void check(int code)
{
    if (code < 0) {
        fprintf(stderr, "spring_block: %s\n", halfstep_error());
        exit(1);
    }
}

static void *room(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (memory == NULL) {
        fprintf(stderr, "spring_block: no memory for %zu particles\n", count);
        exit(1);
    }
    return memory;
}

int main(int argc, char **argv)
{
    const double stiffness = argc > 1 ? atof(argv[1]) : 0.0;
    if (!(stiffness > 0.0)) {
        fprintf(stderr, "usage: spring_block STIFFNESS\n");
        return 1;
    }
    size_t n;
    check(halfstep_particle_count(&n));
    double *rest = room(3 * n, sizeof *rest), *position = room(3 * n, sizeof *position);
    double *velocity = room(3 * n, sizeof *velocity), *forces = room(3 * n, sizeof *forces);
    double *mass = room(n, sizeof *mass), *density = room(n, sizeof *density);
    uint8_t *clamped = room(n, sizeof *clamped);
    check(halfstep_particles(n, rest, velocity, mass, density, clamped));
    double total = 0.0;
    for (size_t k = 0; k < n; k++)
        total += mass[k];

    /* Displacement and velocity at n: at the start, or at the checkpoint that the run goes on from. */
    double at_n[2] = {0.0, 0.0};
    check(halfstep_saved("state", 2, at_n));
    check(halfstep_keep("state", 2, at_n));
    double x_now = at_n[0], v_now = at_n[1]; /* the same at the stage that was published */
    for (size_t k = 0; k < n; k++) {
        position[3 * k] = rest[3 * k] + x_now;
        position[3 * k + 1] = rest[3 * k + 1];
        velocity[3 * k] = v_now;
    }
    /* It slides along the floor on a rail, so walls are its own business. */
    check(halfstep_open(n, position, velocity, mass, density, NULL, 1));
    halfstep_step step;
    int code;
    while ((code = halfstep_wait(&step, n, forces)) == HALFSTEP_OK) {
        double load = 0.0;
        for (size_t k = 0; k < n; k++)
            load += forces[3 * k];
        const double acceleration = (load - stiffness * x_now) / total;
        /* The midpoint rule: both stages go from n, with the rates of the stage. */
        const double x_next = at_n[0] + step.span * v_now, v_next = at_n[1] + step.span * acceleration;
        x_now = x_next;
        v_now = v_next;
        if (step.stage == 1) {
            at_n[0] = x_now;
            at_n[1] = v_now;
            check(halfstep_keep("state", 2, at_n));
        }
        for (size_t k = 0; k < n; k++) {
            position[3 * k] = rest[3 * k] + x_now;
            position[3 * k + 1] = rest[3 * k + 1];
            velocity[3 * k] = v_now;
        }
        check(halfstep_publish(n, position, velocity));
    }
    check(code);
    check(halfstep_close());
    return 0;
}
