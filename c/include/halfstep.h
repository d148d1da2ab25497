/* A solid in C in a fluid-structure simulation by halfstep.
 *
 * A program is one participant of a run and is started by it: `halfstep run SCENE --solid COMMAND`, or alone, pushed by
 * a known force, by `halfstep fake-fluid SCENE --solid COMMAND --force FX,FY`. It goes
 *
 *     halfstep_open(...);
 *     while ((code = halfstep_wait(&step, count, forces)) == HALFSTEP_OK) {
 *         ...                                  from the state at n, by step.span
 *         halfstep_publish(count, position, velocity);
 *     }
 *     halfstep_close();
 *
 * docs/protocol.md has what every solid has to know. Link with -lhalfstep_c.
 *
 * Arrays are of double. Vectors of `count` particles are x, y, z of the first, then of the second, and so on: 3 x count
 * numbers, z zero in two dimensions. Units are SI; in two dimensions masses are kg/m and forces N/m, per metre of depth.
 * Arrays are only used during a call. All calls come from the thread that called halfstep_open.
 *
 * Every function returns one of the codes below; after a negative one halfstep_error() says more, and nothing that the
 * call would have changed has changed. A call that is out of order, a null pointer, a wrong count or a number that
 * nothing has is such an error. A pointer to fewer elements than stated is a mistake that no library can see.
 */
#ifndef HALFSTEP_H
#define HALFSTEP_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HALFSTEP_OK 0        /* done */
#define HALFSTEP_STOPPED 1   /* halfstep_wait: the run has ended as it should, and the solid has left it */
#define HALFSTEP_NOTHING 2   /* halfstep_saved: the run begins, or nothing was kept by that name */
#define HALFSTEP_POINTER -1  /* a pointer is null or not aligned */
#define HALFSTEP_COUNT -2    /* not the solid's number of particles, or more than the run has room for, or none */
#define HALFSTEP_VALUE -3    /* a number is not finite, or not positive where it must be */
#define HALFSTEP_STATE -4    /* not now, or not in this thread */
#define HALFSTEP_RUN -5      /* there is no run, it speaks another version, or another process of it has ended */
#define HALFSTEP_INTERNAL -6 /* a mistake of the library */

/* Quantities of halfstep_diverged. */
#define HALFSTEP_DENSITY 1   /* kg/m3 */
#define HALFSTEP_SPEED 2     /* m/s */
#define HALFSTEP_POSITION 3  /* m */
#define HALFSTEP_STRESS 4    /* Pa */
#define HALFSTEP_TIME_STEP 5 /* s */
#define HALFSTEP_ENERGY 6    /* J, of the whole solid */

/* One half step. Both stages go from the state at n. */
typedef struct halfstep_step {
    uint64_t number;   /* n */
    uint32_t stage;    /* 0: the forces are those at n, the state at n + 1/2 is to be published; 1: the forces are those
                          at n + 1/2, the state at n + 1 is to be published */
    uint32_t reserved; /* 0 */
    double time;       /* at n, s */
    double dt;         /* length of the whole step, s */
    double next_time;  /* at n + 1, s */
    double span;       /* how far this stage goes from n, s: dt / 2, then dt */
} halfstep_step;

/* Text of the last error in this thread, UTF-8, ended by a zero; empty where there was none. It holds until the next
 * call. */
const char *halfstep_error(void);

/* Number of particles that the scene gives this solid. Errors: POINTER, RUN. */
int halfstep_particle_count(size_t *count);

/* These particles: position (m) and velocity (m/s), 3 x count; mass (kg), density (kg/m3) and clamped (1: held),
 * count each. Take them unless there is a reason not to. Errors: POINTER, COUNT, RUN. */
int halfstep_particles(size_t count, double *position, double *velocity, double *mass, double *density,
                       uint8_t *clamped);

/* Number of the connected body of each of them, from 0 on. Errors: POINTER, COUNT, RUN. */
int halfstep_particle_bodies(size_t count, uint32_t *body);

/* Says the body of each particle of the solid that is opened next, for frames; without it nothing is said of bodies.
 * Errors: POINTER; STATE: a solid is open. */
int halfstep_bodies(size_t count, const uint32_t *body);

/* Keeps numbers by a name, whatever the solver needs to go on to the same bits: before halfstep_open those of the first
 * state, then the run writes checkpoints and can be resumed; before halfstep_publish those of the state at n + 1.
 * Errors: POINTER; VALUE: a number is not finite, or the name no UTF-8; STATE: nothing was kept before halfstep_open, or
 * not now. */
int halfstep_keep(const char *name, size_t count, const double *values);

/* The numbers kept by a name at the checkpoint that the run goes on from, with which the solid opens in that very state.
 * HALFSTEP_NOTHING: the run begins. Errors: POINTER, COUNT, VALUE, RUN. */
int halfstep_saved(const char *name, size_t count, double *values);

/* Joins the run with `count` particles and publishes their first state: position (m) and velocity (m/s), 3 x count; mass
 * (kg) and density (kg/m3), count each, positive; `clamped`, count, not 0: the velocity is prescribed, or NULL: nowhere.
 * It returns when all processes of the run are connected. Walls that the scene lets the solid touch push it in two
 * dimensions, by the forces, unless `own_walls` is not 0: then that is the solid's own business.
 * Errors: POINTER, COUNT, VALUE, RUN; STATE: a solid is open already. */
int halfstep_open(size_t count, const double *position, const double *velocity, const double *mass,
                  const double *density, const uint8_t *clamped, int own_walls);

/* Waits for the forces on the state that was published last, N, 3 x count: the whole action of fluid, other solids and
 * walls. Gravity is the solid's own. HALFSTEP_STOPPED: the run is over, nothing was written.
 * Errors: POINTER, COUNT; STATE: a state has to be published first; RUN: the solid has left the run. */
int halfstep_wait(halfstep_step *step, size_t count, double *forces);

/* Publishes the state after the half step that halfstep_wait told: position (m) and velocity (m/s), 3 x count.
 * Errors: POINTER, COUNT, VALUE; STATE: a state is published already; RUN. */
int halfstep_publish(size_t count, const double *position, const double *velocity);

/* Deviatoric stress of the states from now on, for pictures and probes: xx, yy, zz, xy, yz, xz, Pa, 6 x count.
 * Errors: POINTER, COUNT, VALUE, STATE. */
int halfstep_stress(size_t count, const double *stress);

/* Pressure, Pa, for pictures and probes, and density, kg/m3, positive, of the states from now on, count each.
 * Errors: POINTER, COUNT, VALUE, STATE. */
int halfstep_pressure(size_t count, const double *pressure);
int halfstep_density(size_t count, const double *density);

/* In how many steps of its own the solid advances, for run.json. Errors: VALUE: none; STATE. */
int halfstep_sub_steps(uint32_t count);

/* Energy that the solid stores from the next state on, J (2D: J/m). Errors: VALUE, STATE. */
int halfstep_stored_energy(double joules);

/* Largest time step that the solid allows from the next state on, s; without it there is no limit.
 * Errors: VALUE, STATE. */
int halfstep_dt_limit(double seconds);

/* Instead of halfstep_publish: a quantity of a particle (its place, from 0) left its bounds. The run ends and says so.
 * Errors: COUNT: no such particle; VALUE: no such quantity; STATE, RUN. */
int halfstep_diverged(int quantity, uint32_t particle, double value);

/* Leaves the run. Where it is not over it ends, too: the solid has failed. What was said of bodies
 * and kept before halfstep_open is forgotten. Without an open solid it does nothing more. Errors: RUN. */
int halfstep_close(void);

#ifdef __cplusplus
}
#endif

#endif
