//! Brittle cantilevers under a load that grows slowly, beside beam theory.

use super::{Run, solid, strength_and_energy};
use crate::model::SolidModel;

/// A cantilever that a slowly growing traction at its tip bends: E = 1 GPa, f_t = 1 MPa, 40 mm thick.
#[derive(Clone, Copy)]
struct Cantilever {
    /// m.
    length: f64,
    /// Particles across.
    across: f64,
    /// t f_t² / (E G_f). The band holds E' G_f / f_t² apart: below `across`.
    brittleness: f64,
    /// In which the load grows to 1.3 times that of beam theory, s.
    ramp: f64,
    /// Of the lattice, degrees.
    angle: f64,
    /// Its particles lie off the lattice.
    irregular: bool,
    /// It begins with the velocity of a beam whose load grows, so it does not swing.
    glides: bool,
    /// It softens along a straight line.
    linear: bool,
}

const BEAM: Cantilever = Cantilever {
    length: 0.32,
    across: 5.0,
    brittleness: 4.5,
    ramp: 0.16,
    angle: 0.0,
    irregular: false,
    glides: false,
    linear: false,
};

impl Cantilever {
    const THICKNESS: f64 = 0.04;
    /// Load at the end of the ramp over that of beam theory.
    const MOST: f64 = 1.3;

    fn dx(&self) -> f64 {
        Self::THICKNESS / self.across
    }

    /// Out of a lattice that covers more, where it is turned.
    fn text(&self) -> String {
        let (dx, length, t) = (self.dx(), self.length, Self::THICKNESS);
        let energy = t * 1e12 / (1e9 * self.brittleness);
        // The traction with which beam theory has f_t at the root: V (L - dx/2) = f_t t² / 6, V = traction t.
        let traction = Self::MOST * 1e6 * t / (6.0 * (length - 0.5 * dx));
        let (behind, tip) = (4.0 * dx, length - dx);
        let keys = format!(
            "clamp = {{ min = [-{behind}, 0.0], max = [0.0, {t}] }}\n\
             load = {{ within = {{ min = [{tip}, 0.0], max = [{length}, {t}] }}, traction = [0.0, {traction}], \
             ramp = {} }}\n",
            self.ramp
        );
        let beam = "[[shape]]\nname = \"beam\"\nphase = \"solid\"\n";
        let arrangement = if self.irregular { "\narrangement = \"irregular\"" } else { "" };
        let text = solid(dx, 0.0, &(strength_and_energy(1e6, energy) + arrangement));
        if self.angle == 0.0 {
            return text
                + beam
                + &format!("box = {{ min = [-{behind}, 0.0], max = [{length}, {t}] }}\n{keys}");
        }
        let far = 10.0 * length;
        [
            ([-far, -far], [far, 0.0]),
            ([-far, t], [far, far]),
            ([-far, -far], [-behind, far]),
            ([length, -far], [far, far]),
        ]
        .iter()
        .enumerate()
        .fold(text, |text, (k, (min, max))| {
            text + &format!(
                "[[shape]]\nname = \"void-{k}\"\nphase = \"void\"\nbox = {{ min = {min:?}, max = {max:?} }}\n"
            )
        }) + beam
            + &format!(
                "box = {{ min = [{}, {}], max = [{}, {}] }}\nrotate = {{ angle = {}, about = [0.0, 0.0] }}\n{keys}",
                -0.3 * length,
                -0.8 * length,
                1.1 * length,
                0.4 * length,
                self.angle
            )
    }

    /// The run, and the rate of the load over that of beam theory, 1/s.
    fn begun(&self) -> (Run<2>, f64) {
        let mut run = Run::<2>::of(&self.text());
        let (t, dx) = (Self::THICKNESS, self.dx());
        // Whole cells carry the load: in a turned lattice more or less of them than the box is long.
        let places = run.model.particles().position.to_vec();
        let loaded: Vec<f64> = places.iter().map(|x| x[0]).filter(|x| *x > self.length - dx).collect();
        let arm = loaded.iter().sum::<f64>() / loaded.len() as f64;
        let share = loaded.len() as f64 * dx * arm / (t * (self.length - 0.5 * dx));
        let rate = Self::MOST * share / self.ramp;
        if self.glides {
            // w = V x² (3 a - x) / (6 E I) with V a = f_t t² / 6.
            let force = rate * 1e6 * t * t / (6.0 * arm) / (6.0 * 1e9 * t.powi(3) / 12.0);
            for (p, [x, y]) in places.into_iter().enumerate() {
                let (slot, x) = (run.model.slot_of[p] as usize, x.clamp(0.0, self.length));
                run.model.now.velocity[0][slot] = -(y - 0.5 * t) * force * 3.0 * x * (2.0 * arm - x);
                run.model.now.velocity[1][slot] = force * x * x * (3.0 * arm - x);
            }
        }
        (run, rate)
    }

    /// The load at the first damage and at the cut through half of the thickness, over that of beam theory.
    fn broken(&self) -> [f64; 2] {
        let (mut run, rate) = self.begun();
        run.model.fracture.as_mut().expect("a brittle beam").linear = self.linear;
        while run.model.summary().energy == 0.0 {
            run.step();
        }
        let first = rate * run.time;
        while run.model.summary().area < 0.5 * Self::THICKNESS {
            assert!(run.time < self.ramp, "it holds");
            run.step();
        }
        let both = [first, rate * run.time];
        let Self { length, across, brittleness, ramp, angle, irregular, glides, linear } = self;
        println!(
            "{length} m, {across} across, window {brittleness}, {ramp} s, {angle} degrees, irregular {irregular}, glides \
             {glides}, linear {linear}: first damage {:.4}, cut through half {:.4}",
            both[0], both[1]
        );
        both
    }

    /// Both as measured, to 1 %.
    fn breaks_at(&self, measured: [f64; 2]) {
        for (found, measured) in self.broken().into_iter().zip(measured) {
            assert!((found / measured - 1.0).abs() < 0.01, "{found} {measured}");
        }
    }
}

/// Asked for are 5 and 10 %; bands of 1 % about what is measured lie within, but for the swing of the short ramp.
#[test]
fn a_brittle_cantilever_breaks_where_beam_theory_says() {
    let short = Cantilever { length: 0.16, ramp: 0.06, ..BEAM };
    let fine = Cantilever { across: 10.0, brittleness: 8.0, ..short };
    for (beam, measured) in [
        (BEAM, [0.969, 0.983]),
        (Cantilever { ramp: 0.12, ..short }, [0.958, 0.976]),
        (short, [0.946, 0.9815]),
        (fine, [0.941, 0.951]),
        // A softening along a straight line bears more before it is cut, by 0.4 and 2.7 %.
        (Cantilever { linear: true, ..short }, [0.946, 0.9855]),
        (Cantilever { linear: true, ..fine }, [0.941, 0.9765]),
    ] {
        beam.breaks_at(measured);
    }
}

/// Without a swing. Plane elasticity has the outermost particle at the clamp reach f_t at 0.98 (10 across) and 0.97
/// (20) of beam theory's load: the clamp holds the section from warping. Measured: 0.965 and 0.962; the break at 0.968
/// and 1.025. Asked for are 5 and 10 %; bands of 1 % about what is measured lie within. In the turned lattice the first
/// damage misses them, and the break meets them where the band is wide beside the spacing: 20 across, 4.5.
#[test]
#[ignore = "a quarter of an hour"]
fn finer_cantilevers_break_where_beam_theory_says() {
    let cases = [
        (5.0, 4.5, 0.0, [0.959, 0.973]),
        (10.0, 8.0, 0.0, [0.965, 0.968]),
        (20.0, 8.0, 0.0, [0.962, 1.025]),
        (10.0, 4.5, 0.0, [0.965, 1.061]),
        (10.0, 8.0, 30.0, [0.829, 0.830]),
        (10.0, 4.5, 30.0, [0.829, 0.835]),
        (20.0, 8.0, 30.0, [0.795, 0.852]),
        (20.0, 4.5, 30.0, [0.795, 0.933]),
    ];
    for (across, brittleness, angle, measured) in cases {
        Cantilever { across, brittleness, angle, glides: true, ..BEAM }.breaks_at(measured);
    }
}

/// Off the lattice, with faces that lie along it, it breaks as one on it.
#[test]
#[ignore = "a minute"]
fn an_irregular_cantilever_breaks_where_beam_theory_says() {
    for (brittleness, measured) in [(8.0, [0.959, 0.962]), (4.5, [0.959, 1.043])] {
        let beam = Cantilever { across: 10.0, brittleness, irregular: true, glides: true, ..BEAM };
        beam.breaks_at(measured);
    }
}

/// The tension in the inner corners of a ragged face, over that of beam theory in the same place: a corner whose cell
/// is missing is a notch.
#[test]
#[ignore = "minutes"]
fn a_ragged_face_is_a_row_of_notches() {
    for (across, measured) in [(10.0, 1.75), (20.0, 1.52)] {
        let beam = Cantilever { across, angle: 30.0, glides: true, ..BEAM };
        let (mut run, rate) = beam.begun();
        let places = run.model.particles().position.to_vec();
        let corners: Vec<(usize, f64)> = (0..places.len())
            .filter_map(|p| {
                let (slot, [x, y]) = (run.model.slot_of[p] as usize, places[p]);
                let nominal = (1.0 - 2.0 * y / Cantilever::THICKNESS) * (1.0 - x / beam.length);
                let inside = run.model.fracture.as_ref().expect("a brittle beam").outward[slot] == [0.0; 2];
                (inside && run.model.is_free(slot) && (0.2..1.5).contains(&(x / Cantilever::THICKNESS)))
                    .then_some((slot, nominal))
                    .filter(|_| y < 1.5 * beam.dx())
            })
            .collect();
        let (mut sums, mut count) = (vec![0.0; corners.len()], 0.0);
        while rate * run.time < 0.7 {
            run.step();
            if rate * run.time > 0.5 {
                count += 1.0;
                for (sum, (slot, nominal)) in sums.iter_mut().zip(&corners) {
                    *sum += run.model.tension(*slot) / (rate * run.time * 1e6 * nominal);
                }
            }
        }
        let mean = sums.into_iter().fold(0.0, f64::max) / count;
        println!(
            "{across} across: {mean:.3} of the beam's tension in the sharpest of {} corners",
            corners.len()
        );
        assert!((mean / measured - 1.0).abs() < 0.02, "{across}: {mean}");
    }
}

/// What fracture takes of a cantilever of few rows that its own weight breaks, until it is off, over G_f t: the edges
/// of its last row tear, which held as a hinge and took 1.7 to 70 times as much.
#[test]
fn walls_of_few_rows_take_their_fracture_energy() {
    let dx = 0.005;
    let mut found = Vec::new();
    for rows in [6.0, 5.0, 4.0, 3.0, 2.0] {
        let t = rows * dx;
        let text = format!(
            "resolution = {dx}\nend_time = 1.0\ngravity = [0.0, -9.81]\n[solid]\ndensity = 2400.0\n\
             youngs_modulus = 1e9\npoissons_ratio = 0.2\n{}\n[[shape]]\nname = \"bar\"\nphase = \"solid\"\n\
             box = {{ min = [-0.01, 0.0], max = [0.21, {t}] }}\n\
             clamp = {{ min = [-0.02, -0.01], max = [0.0, {}] }}\n",
            strength_and_energy(5e4, 0.1),
            t + 0.01
        );
        let mut run = Run::<2>::of(&text);
        while run.model.summary().bodies == 1 && run.time < 0.1 {
            run.step();
        }
        let summary = run.model.summary();
        let ratio = summary.energy / (0.1 * t);
        println!("{rows} rows: {ratio:.3} of G_f t, off at {:.4} s, {} loose", run.time, summary.loose);
        found.push((rows, summary.bodies, ratio));
    }
    for (rows, bodies, ratio) in found {
        assert!(bodies > 1 && (ratio - 1.0).abs() < 0.25, "{rows} rows: {bodies} bodies, {ratio}");
    }
}

/// A turned lattice has ragged faces and clamps: the first damage misses the 5 % of a straight one.
#[test]
fn a_cantilever_of_a_turned_lattice_breaks_earlier() {
    Cantilever { angle: 30.0, ..BEAM }.breaks_at([0.923, 0.942]);
}
